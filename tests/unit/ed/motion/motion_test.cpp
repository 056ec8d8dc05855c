#include <motion/axis_motion.h>
#include <motion/checks.h>

#include <common/finder/reference.h>

#include <ed/motion.h>
#include <ed/random.h>

#include <geom/pose.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using ed::Motion;
using ed::propagate;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// One row of free_top.csv: a top that starts with its body axes along x, y, z, and where it is at t. 20 digits.
struct TopRow {
  Vector3d inertia;
  Vector3d omega_start;  ///< body frame, here also world
  double t;
  Vector3d omega_body;
  Matrix3d rotation;
};

std::vector<TopRow> read_rows() {
  std::ifstream file(std::string(HARDBODY_REFERENCE_DIR) + "/free_top.csv");
  std::vector<TopRow> rows;
  for (std::string line; std::getline(file, line);) {
    std::array<double, 14> v{};
    std::istringstream fields(line);
    std::size_t k = 0;
    for (std::string field; k < v.size() && std::getline(fields, field, ',');) {
      std::istringstream number(field);
      if (!(number >> v[k])) break;
      ++k;
    }
    if (k < v.size()) continue;  // headers
    rows.push_back({{v[0], v[1], v[2]},
                    {v[3], v[4], v[5]},
                    v[6],
                    {v[7], v[8], v[9]},
                    Eigen::Quaterniond(v[10], v[11], v[12], v[13]).toRotationMatrix()});
  }
  return rows;
}

/// The body axes renamed in cyclic order: old axis k becomes axis (k + shift) mod 3.
Matrix3d renamed(int shift) {
  Matrix3d P = Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) P(k, (k + shift) % 3) = 1;
  return P;
}

TEST(Propagate, FollowsTheReferenceTopsAboutEveryBodyAxis) {
  int rows = 0;
  for (const TopRow& row : read_rows()) {
    ++rows;
    for (int shift = 0; shift < 3; ++shift) {
      // In a world frame turned by Q nothing else changes.
      const Matrix3d Q = Eigen::AngleAxisd(0.7 * shift, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
      const Matrix3d P = renamed(shift);
      Motion start;
      start.pose = geom::Pose(Q * P, {1, -2, 3});
      start.velocity = {0.5, 0.25, -1};
      start.angular_velocity = Q * row.omega_start;
      start.inertia = P.transpose() * row.inertia;
      start.time = 2;
      const Motion end = propagate(start, 2 + row.t);
      const Matrix3d R = Q * row.rotation;
      EXPECT_LE((end.pose.rotation() - R * P).cwiseAbs().maxCoeff(), 1e-12);
      EXPECT_LE((end.angular_velocity - R * row.omega_body).norm(), 1e-12);
      EXPECT_LE((end.pose.position() - Vector3d(1, -2, 3) - row.t * start.velocity).norm(), 1e-14 * (4 + row.t));
      EXPECT_EQ(end.time, 2 + row.t);
    }
  }
  EXPECT_EQ(rows, 4);
}

/// Random state of a top with two equal moments, about body axis `axis`, or with three different ones (axis 3).
Motion draw(ed::Random& random, int axis) {
  Motion m;
  m.pose = geom::Pose(random.rotation(), random.normal3());
  m.velocity = random.normal3();
  m.angular_velocity = 2 * random.normal3();
  const double perpendicular = 0.3 + random.uniform();
  m.inertia = Vector3d::Constant(perpendicular);
  const double other = 0.05 + 0.95 * random.uniform();
  if (axis < 3) {
    m.inertia[axis] = 2 * perpendicular * other;  // from needles to discs
  } else {
    m.inertia = perpendicular * Vector3d(1 + other, 1.3, 0.3 + other);
  }
  m.time = random.normal();
  return m;
}

Vector3d angular_momentum(const Motion& m) {
  const Matrix3d& R = m.pose.rotation();
  return R * (m.inertia.asDiagonal() * (R.transpose() * m.angular_velocity));
}

double rotational_energy(const Motion& m) {
  return 0.5 * m.angular_velocity.dot(angular_momentum(m));
}

void expect_same(const Motion& a, const Motion& b, double tolerance) {
  EXPECT_LE((a.pose.rotation() - b.pose.rotation()).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LE((a.pose.position() - b.pose.position()).norm(), tolerance);
  EXPECT_LE((a.velocity - b.velocity).norm(), tolerance);
  EXPECT_LE((a.angular_velocity - b.angular_velocity).norm(), tolerance);
}

// Angles of up to some tens of radians carry rounding errors of some 1e-15 each; what follows is told from a wrong
// formula by ten orders of magnitude.
constexpr double kRounding = 2e-13;

TEST(Propagate, KeepsEnergyAngularMomentumAndARotationMatrix) {
  ed::Random random(41);
  for (int k = 0; k < 3000; ++k) {
    const Motion start = draw(random, k % 4);
    const Motion end = propagate(start, start.time + 10 * random.normal());
    EXPECT_LE((angular_momentum(end) - angular_momentum(start)).norm(), kRounding);
    EXPECT_NEAR(rotational_energy(end), rotational_energy(start), kRounding * (1 + rotational_energy(start)));
    const Matrix3d& R = end.pose.rotation();
    EXPECT_LE((R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_EQ(end.velocity, start.velocity);
    EXPECT_EQ(end.inertia, start.inertia);
  }
}

TEST(Propagate, TwoStepsAreOne) {
  ed::Random random(42);
  for (int k = 0; k < 3000; ++k) {
    const Motion start = draw(random, k % 4);
    const double t1 = start.time + 3 * random.normal();
    const double t2 = t1 + 3 * random.normal();
    expect_same(propagate(propagate(start, t1), t2), propagate(start, t2), kRounding);
  }
}

TEST(Propagate, BackAndForthOrWithReversedVelocitiesReturns) {
  ed::Random random(43);
  for (int k = 0; k < 3000; ++k) {
    const Motion start = draw(random, k % 4);
    const double t = start.time + 5 * random.normal();
    Motion end = propagate(start, t);
    expect_same(propagate(end, start.time), start, kRounding);
    end.velocity *= -1;
    end.angular_velocity *= -1;
    Motion back = propagate(end, t + (t - start.time));
    back.velocity *= -1;
    back.angular_velocity *= -1;
    expect_same(back, start, kRounding);
  }
}

TEST(Propagate, ToItsOwnTimeChangesNothing) {
  ed::Random random(44);
  const Motion start = draw(random, 2);
  expect_same(propagate(start, start.time), start, 1e-15);
}

TEST(Propagate, SphericalTopTurnsUniformly) {
  ed::Random random(45);
  for (int k = 0; k < 1000; ++k) {
    Motion start = draw(random, 2);
    start.inertia = Vector3d::Constant(0.4);
    const double dt = 5 * random.normal();
    const double rate = start.angular_velocity.norm();
    Motion expected = start;
    expected.pose = geom::Pose(
        Eigen::AngleAxisd(rate * dt, start.angular_velocity / rate).toRotationMatrix() * start.pose.rotation(),
        start.pose.position() + dt * start.velocity);
    expect_same(propagate(start, start.time + dt), expected, kRounding);
  }
}

TEST(Propagate, WithoutSpinTheAxisRunsOnAGreatCircle) {
  Motion start;
  start.inertia = {0.5, 0.5, 0.1};
  start.angular_velocity = {0, 2, 0};
  const Motion end = propagate(start, 0.6);
  const Matrix3d expected = Eigen::AngleAxisd(1.2, Vector3d::UnitY()).toRotationMatrix();
  EXPECT_LE((end.pose.rotation() - expected).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_LE((end.angular_velocity - start.angular_velocity).norm(), 1e-15);
}

TEST(Propagate, PureSpinLeavesTheAxisWhereItIs) {
  for (int axis = 0; axis < 3; ++axis) {
    Motion start;
    start.inertia = Vector3d::Constant(0.5);
    start.inertia[axis] = 0.1;
    start.angular_velocity = 3 * Vector3d::Unit(axis);
    const Motion end = propagate(start, -0.7);
    const Matrix3d expected = Eigen::AngleAxisd(-2.1, Vector3d::Unit(axis)).toRotationMatrix();
    EXPECT_LE((end.pose.rotation() - expected).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LE((end.angular_velocity - start.angular_velocity).norm(), 1e-15);
  }
}

TEST(Propagate, ABodyAtRestStaysAtRest) {
  Motion start;
  start.pose = geom::Pose(Eigen::AngleAxisd(1, Vector3d::UnitX()).toRotationMatrix(), {1, 2, 3});
  const Motion end = propagate(start, 1e6);
  EXPECT_LE((end.pose.rotation() - start.pose.rotation()).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(end.pose.position(), start.pose.position());
  EXPECT_EQ(end.angular_velocity, Vector3d(0, 0, 0));
}

TEST(Propagate, AgreesWithTheMotionThatTheBruteForceTestsUse) {
  ed::Random random(46);
  for (int k = 0; k < 1000; ++k) {
    Motion start = draw(random, 2);
    start.time = 0;
    finder_test::BodyState state;
    state.position = start.pose.position();
    state.rotation = start.pose.rotation();
    state.velocity = start.velocity;
    state.spin = start.angular_velocity.dot(state.axis());
    state.across = start.angular_velocity - state.spin * state.axis();
    const double t = 5 * random.normal();
    const finder_test::BodyState there = finder_test::FreeMotion(state, {start.inertia.x(), start.inertia.z()}).at(t);
    Motion expected = start;
    expected.pose = geom::Pose(there.rotation, there.position);
    expected.angular_velocity = there.omega();
    expect_same(propagate(start, t), expected, kRounding);
  }
}

// ---- Refusals ------------------------------------------------------------------------------------------------------

std::string refusal(const std::function<void(Motion&)>& spoil, double t = 1) {
  Motion motion;
  spoil(motion);
  try {
    (void)propagate(motion, t);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Propagate, RefusesWhatNoBodyCanHaveAndNamesIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const auto has = [](const std::string& message, const std::string& word) {
    return message.find(word) != std::string::npos;
  };
  EXPECT_PRED2(has, refusal([&](Motion& m) { m.velocity.y() = nan; }), "velocity");
  EXPECT_PRED2(has, refusal([&](Motion& m) { m.angular_velocity.x() = inf; }), "angular velocity");
  EXPECT_PRED2(has, refusal([&](Motion& m) { m.time = -inf; }), "time is -inf;");
  EXPECT_PRED2(has, refusal([](Motion&) {}, nan), "t is nan;");
  EXPECT_PRED2(has, refusal([&](Motion& m) { m.inertia.z() = nan; }), "inertia");
  EXPECT_PRED2(has, refusal([](Motion& m) { m.inertia = {1, 1, 0}; }), "inertia");
  EXPECT_PRED2(has, refusal([](Motion& m) { m.inertia = {1, -1, 1}; }), "inertia");
  // No moment exceeds the sum of the other two.
  EXPECT_PRED2(has, refusal([](Motion& m) { m.inertia = {1, 1, 2.001}; }), "none exceeds the sum");
  EXPECT_EQ(refusal([](Motion& m) { m.inertia = {1, 1, 2}; }), "accepted");  // a thin disc
  EXPECT_EQ(refusal([](Motion& m) { m.inertia = {1, 1.1, 1.2}; }), "accepted");
}

// ---- Integrals of the angular velocity -----------------------------------------------------------------------------

struct Integrals {
  Vector3d lab = Vector3d::Zero();
  Eigen::Vector2d body = Eigen::Vector2d::Zero();
};

/// Simpson's rule over [t0, t0 + span] with the closed-form state at each node, the part of omega across the axis only.
Integrals quadrature(const ed::internal::TopMotion& start, double span, int intervals) {
  Integrals sum;
  for (int k = 0; k <= intervals; ++k) {
    ed::internal::TopMotion top = start;
    ed::internal::advance(top.inertia, start.axis.time + span * k / intervals, top.axis, top.frame);
    const double weight = (k == 0 || k == intervals ? 1 : (k % 2 == 1 ? 4 : 2)) * span / (3 * intervals);
    const Vector3d omega = ed::internal::omega_across(top.axis);
    const Vector3d y_axis = top.axis.axis().cross(top.frame.x_axis);
    sum.lab += weight * omega;
    sum.body += weight * Eigen::Vector2d(omega.dot(top.frame.x_axis), omega.dot(y_axis));
  }
  return sum;
}

TEST(BodyFrameIntegrals, AreTheQuadratureOfOmegaWithAndWithoutSpin) {
  ed::Random random(47);
  for (int k = 0; k < 60; ++k) {
    Motion start = draw(random, 2);
    ed::internal::TopMotion top = ed::internal::top_motion(start, 2);
    if (k % 2 == 0) {
      top.inertia.spins = false;
      top.frame.spin = 0;
      ed::internal::set_rotation(top.inertia, top.axis.axis(), ed::internal::omega_across(top.axis), top.axis,
                                 top.frame);
    }
    const double span = 2 * random.normal();
    const Integrals wanted = quadrature(top, span, 2000);
    ed::internal::TopMotion end = top;
    ed::internal::advance(top.inertia, top.axis.time + span, end.axis, end.frame);
    // Simpson: (rate * step)^4 / 180 of the integral; rates up to 30, steps of some 1e-3.
    const double tolerance = 1e-8;
    EXPECT_LE((end.frame.phi_lab - wanted.lab).norm(), tolerance);
    EXPECT_LE((end.frame.phi_body - wanted.body).norm(), tolerance);
    EXPECT_EQ(end.frame.spin, top.frame.spin);
  }
}

TEST(BodyFrameIntegrals, AddUpOverShortAndLongFlights) {
  // Short ones take the series, long ones the closed form.
  ed::Random random(48);
  for (int k = 0; k < 60; ++k) {
    ed::internal::TopMotion once = ed::internal::top_motion(draw(random, 2), 2);
    ed::internal::TopMotion often = once;
    const double start = once.axis.time;
    constexpr int kSteps = 4096;
    ed::internal::advance(once.inertia, start + 1, once.axis, once.frame);
    for (int step = 1; step <= kSteps; ++step) {
      ed::internal::advance(often.inertia, start + static_cast<double>(step) / kSteps, often.axis, often.frame);
    }
    // 4096 steps, each with rounding errors of some 1e-16 in the orientation.
    EXPECT_LE((once.frame.phi_lab - often.frame.phi_lab).norm(), 1e-11);
    EXPECT_LE((once.frame.phi_body - often.frame.phi_body).norm(), 1e-11);
    EXPECT_LE((once.axis.axis() - often.axis.axis()).norm(), 1e-11);
    EXPECT_LE((once.frame.x_axis - often.frame.x_axis).norm(), 1e-11);
    EXPECT_EQ(once.frame.spin, often.frame.spin);
  }
}

TEST(BodyFrameIntegrals, WithoutSpinAreTheSameAngleInBothFrames) {
  ed::internal::UniaxialInertia inertia;
  ed::internal::AxisMotion axis;
  ed::internal::BodyFrame frame;
  axis.position.setZero();
  axis.velocity.setZero();
  axis.time = 0;
  frame.x_axis = Vector3d::UnitX();
  ed::internal::set_rotation(inertia, Vector3d::UnitZ(), {0, 3, 0}, axis, frame);
  ed::internal::advance(inertia, 2, axis, frame);
  EXPECT_LE((frame.phi_lab - Vector3d(0, 6, 0)).norm(), 1e-14);
  EXPECT_LE((frame.phi_body - Eigen::Vector2d(0, 6)).norm(), 1e-14);
}

}  // namespace
