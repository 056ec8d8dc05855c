#include <free_top.h>

#include <common/finder_ensemble.h>
#include <common/top_reference.h>

#include <ed/random.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace {

using ed::internal::FreeTop;
using ed::internal::TopState;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using finder_test::IntegratedTop;
using finder_test::log_uniform;

struct Start {
  Vector3d inertia = Vector3d::Ones();
  Matrix3d rotation = Matrix3d::Identity();
  Vector3d omega = Vector3d::Zero();

  FreeTop top() const { return FreeTop(inertia, rotation, omega); }
};

double rate_scale(const Start& s) {
  return s.omega.norm();
}

/// Random::rotation keeps some 1e-14; the tests below tell 1e-15.
Matrix3d orthonormal(const Matrix3d& m) {
  Matrix3d R;
  R.col(2) = m.col(2).normalized();
  R.col(0) = (m.col(0) - R.col(2).dot(m.col(0)) * R.col(2)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

Start with_rotation(ed::Random& random, const Vector3d& inertia) {
  Start s;
  s.inertia = inertia;
  s.rotation = orthonormal(random.rotation());
  // Thermal: every axis carries the same energy on average.
  s.omega = s.rotation * random.normal3().cwiseQuotient(s.inertia.cwiseSqrt());
  return s;
}

Start draw_spherical(ed::Random& random) {
  return with_rotation(random, Vector3d::Constant(log_uniform(random, 0.1, 10)));
}

/// From needles to discs, about any body axis.
Start draw_symmetric(ed::Random& random) {
  const double perpendicular = log_uniform(random, 0.1, 10);
  Vector3d inertia = Vector3d::Constant(perpendicular);
  const int axis = static_cast<int>(3 * random.uniform());
  inertia[axis] = perpendicular * (random.uniform() < 0.5 ? 2 - log_uniform(random, 1e-12, 1.9)  //
                                                          : log_uniform(random, 1e-3, 2));
  return with_rotation(random, inertia);
}

using Draw = Start (*)(ed::Random&);

struct Kind {
  std::string name;
  Draw draw;
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

class FreeTops : public testing::TestWithParam<Kind> {
 protected:
  Start draw() { return GetParam().draw(random_); }
  ed::Random random_{71};
};

INSTANTIATE_TEST_SUITE_P(Kinds, FreeTops,
                         testing::Values(Kind{"Spherical", draw_spherical}, Kind{"Symmetric", draw_symmetric}),
                         [](const auto& kind) { return kind.param.name; });

double difference(const Matrix3d& a, const IntegratedTop::Matrix& b) {
  return static_cast<double>((a.cast<long double>() - b).cwiseAbs().maxCoeff());
}

double difference(const Vector3d& a, const IntegratedTop::Vector& b) {
  return static_cast<double>((a.cast<long double>() - b).norm());
}

TEST_P(FreeTops, AreTheIntegratedEquationsOfMotion) {
  for (int k = 0; k < 300; ++k) {
    const Start start = draw();
    const double rate = rate_scale(start);
    const double t = (k % 10 == 0 ? 100 : 5) * random_.normal() / rate;
    IntegratedTop wanted(start.inertia, start.rotation, start.omega);
    wanted.advance(t);
    const FreeTop top = start.top();
    const TopState end = top.at(t);
    const double tolerance = 3e-15 * (1 + rate * std::abs(t));
    EXPECT_LE(difference(end.R, wanted.rotation()), tolerance);
    EXPECT_LE(difference(end.omega, wanted.omega()), tolerance * rate);
    EXPECT_LE(difference(top.turned_world(t), wanted.turned_world()), tolerance * (1 + rate * std::abs(t)));
    EXPECT_LE(difference(top.turned_body(t), wanted.turned_body()), tolerance * (1 + rate * std::abs(t)));
    EXPECT_EQ(top.rotation(t), end.R);
  }
}

TEST_P(FreeTops, StartWhereTheyAreToldTo) {
  for (int k = 0; k < 10'000; ++k) {
    const Start start = draw();
    const TopState now = start.top().at(0);
    EXPECT_LE((now.R - start.rotation).cwiseAbs().maxCoeff(), 2e-15);
    EXPECT_LE((now.omega - start.omega).norm(), 2e-15 * start.omega.norm());
    EXPECT_EQ(start.top().turned_world(0), Vector3d(0, 0, 0));
    EXPECT_EQ(start.top().turned_body(0), Vector3d(0, 0, 0));
  }
}

TEST_P(FreeTops, HaveOrthonormalMatrices) {
  for (int k = 0; k < 10'000; ++k) {
    const Start start = draw();
    const Matrix3d R = start.top().rotation(10 * random_.normal() / rate_scale(start));
    EXPECT_LE((R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_GT(R.determinant(), 0.999);
  }
}

TEST_P(FreeTops, KeepAngularMomentumAndEnergy) {
  const auto momentum = [](const Start& s, const Matrix3d& R, const Vector3d& omega) {
    return Vector3d(R * s.inertia.cwiseProduct(R.transpose() * omega));
  };
  for (int k = 0; k < 3000; ++k) {
    const Start start = draw();
    const FreeTop top = start.top();
    const Vector3d L = momentum(start, start.rotation, start.omega);
    const double energy = start.omega.dot(L);
    for (const double t : {0.3, 7.0, -50.0}) {
      const TopState now = top.at(t / rate_scale(start));
      const Vector3d L_now = momentum(start, now.R, now.omega);
      // A needle's L is little beside what rounding of its fast spin makes of it.
      EXPECT_LE((L_now - L).norm(), 1e-14 * start.inertia.maxCoeff() * start.omega.norm());
      EXPECT_NEAR(now.omega.dot(L_now), energy, 1e-14 * energy);
    }
  }
}

TEST_P(FreeTops, GoOnWhereTheyWereStoppedAndComeBack) {
  for (int k = 0; k < 3000; ++k) {
    const Start start = draw();
    const double rate = rate_scale(start);
    const double t1 = 3 * random_.normal() / rate;
    const double t2 = 3 * random_.normal() / rate;
    const FreeTop top = start.top();
    const TopState half = top.at(t1);
    const TopState end = top.at(t1 + t2);
    const FreeTop rest = Start{start.inertia, half.R, half.omega}.top();
    const FreeTop back = Start{start.inertia, end.R, -end.omega}.top();
    const double tolerance = 3e-15 * (1 + rate * (std::abs(t1) + std::abs(t2)));
    EXPECT_LE((rest.rotation(t2) - end.R).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LE((rest.at(t2).omega - end.omega).norm(), tolerance * rate);
    EXPECT_LE((back.rotation(t1 + t2) - start.rotation).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LE((back.at(t1 + t2).omega + start.omega).norm(), tolerance * rate);
    // Integrals add up; the body's axes have not been renamed, the world's have not been turned.
    EXPECT_LE((top.turned_world(t1) + rest.turned_world(t2) - top.turned_world(t1 + t2)).norm(), 5 * tolerance);
    EXPECT_LE((top.turned_body(t1) + rest.turned_body(t2) - top.turned_body(t1 + t2)).norm(), 5 * tolerance);
  }
}

/// Central differences with step h: errors of h^2 (rate^3 or rate^4) / 6, and 1e-16 rate / h of rounding.
TEST_P(FreeTops, HaveTheRatesThatTheyName) {
  for (int k = 0; k < 1000; ++k) {
    const Start start = draw();
    const FreeTop top = start.top();
    const double rate = top.max_omega();
    const double t = 5 * random_.normal() / rate;
    const double h = 1e-4 / rate;
    const TopState before = top.at(t - h);
    const TopState now = top.at(t);
    const TopState after = top.at(t + h);
    EXPECT_LE(((after.omega - before.omega) / (2 * h) - now.alpha).norm(), 1e-7 * rate * rate);
    const Matrix3d turning = (after.R - before.R) / (2 * h);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE((turning.col(axis) - now.omega.cross(now.R.col(axis))).norm(), 1e-7 * rate);
    }
  }
}

/// |omega|, |alpha| and |jerk| over a long flight against their bounds: never above, and the bound nearly reached.
TEST_P(FreeTops, KeepTheirBounds) {
  for (int k = 0; k < 2000; ++k) {
    const Start start = draw();
    const FreeTop top = start.top();
    const double rate = top.max_omega();
    for (int step = 0; step < 50; ++step) {
      const double t = 100 * (random_.uniform() - 0.5) / rate;
      const TopState now = top.at(t);
      EXPECT_LE(now.omega.norm(), top.max_omega());
      EXPECT_LE(now.alpha.norm(), top.max_alpha() * (1 + 1e-13) + 1e-15 * rate * rate);
      // Chords of alpha are no longer than the time times the jerk; 1e-13: rounding of the difference.
      const double h = 1e-3 / rate;
      EXPECT_LE((top.at(t + h).alpha - now.alpha).norm() / h,
                top.max_jerk() * (1 + 1e-12) + 1e-12 * rate * rate * rate);
    }
  }
}

TEST_P(FreeTops, StayRightOnVeryLongFlights) {
  // Angles of 1e9 radian keep seven digits; the matrix stays a rotation.
  const Start start = draw();
  const FreeTop top = start.top();
  const double t = 1e9 / rate_scale(start);
  const TopState there = top.at(t);
  EXPECT_LE((there.R.transpose() * there.R - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-15);
  const FreeTop rest = Start{start.inertia, there.R, there.omega}.top();
  EXPECT_LE((rest.rotation(-t) - start.rotation).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(FreeTop, AtRestStaysAtRest) {
  for (const Vector3d& inertia : {Vector3d(1, 1, 1), Vector3d(1, 1, 0.2)}) {
    Start start;
    start.inertia = inertia;
    start.rotation = Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const FreeTop top = start.top();
    const TopState there = top.at(1e300);
    EXPECT_LE((there.R - start.rotation).cwiseAbs().maxCoeff(), 3e-16);
    EXPECT_EQ(there.omega, Vector3d(0, 0, 0));
    EXPECT_EQ(there.alpha, Vector3d(0, 0, 0));
    EXPECT_EQ(top.max_omega(), 0);
    EXPECT_EQ(top.max_alpha(), 0);
    EXPECT_EQ(top.max_jerk(), 0);
    EXPECT_EQ(top.turned_world(5), Vector3d(0, 0, 0));
    EXPECT_EQ(top.turned_body(5), Vector3d(0, 0, 0));
  }
  EXPECT_EQ(FreeTop().rotation(3), Matrix3d::Identity());
}

}  // namespace
