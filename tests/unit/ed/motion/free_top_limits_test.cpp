// Free tops at rest, about principal axes, near the separatrix, and where kinds of tops meet.

#include <motion/free_top.h>

#include <common/finder/ensemble.h>
#include <common/finder/free_tops.h>
#include <common/finder/top_reference.h>

#include <ed/random.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using ed::internal::FreeTop;
using ed::internal::TopState;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using finder_test::IntegratedTop;
using finder_test::log_uniform;
using free_tops::difference;
using free_tops::Start;
using free_tops::with_rotation;

TEST(FreeTop, AtRestStaysAtRest) {
  for (const Vector3d& inertia : {Vector3d(1, 1, 1), Vector3d(1, 1, 0.2), Vector3d(1, 0.7, 0.5)}) {
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
    EXPECT_EQ(top.turned(5).world, Vector3d(0, 0, 0));
    EXPECT_EQ(top.turned(5).body, Vector3d(0, 0, 0));
  }
  EXPECT_EQ(FreeTop().rotation(3), Matrix3d::Identity());
}

TEST(FreeTop, KeepsTurningAboutAPrincipalAxisEvenTheUnstableOne) {
  for (int axis = 0; axis < 3; ++axis) {
    Start start;
    start.inertia = {1, 2, 2.5};
    start.omega = 3 * Vector3d::Unit(axis);
    const FreeTop top = start.top();
    for (const double t : {0.4, -12.0, 1e5}) {
      const Matrix3d expected = Eigen::AngleAxisd(3 * t, Vector3d::Unit(axis)).toRotationMatrix();
      const TopState there = top.at(t);
      EXPECT_LE((there.R - expected).cwiseAbs().maxCoeff(), 1e-15 * (1 + std::abs(t)));
      EXPECT_EQ(there.omega, start.omega);
      EXPECT_EQ(there.alpha, Vector3d(0, 0, 0));
      EXPECT_LE((top.turned(t).body - t * start.omega).norm(), 1e-15 * std::abs(t));
    }
    EXPECT_NEAR(top.max_omega(), 3, 1e-13);
    EXPECT_EQ(top.max_alpha(), 0);
  }
}

/// Expects an answer that is as good as omega is known, where the motion itself magnifies small changes: beyond
/// rounding the error is no more than four times what a change of one component of omega in its last place does, by
/// integration.
void expect_as_good_as_omega(const Start& start, double t) {
  using Real = IntegratedTop::Real;
  const auto integrated = [&](const Vector3d& omega) {
    IntegratedTop top(start.inertia, start.rotation, omega);
    top.advance(t);
    return top.rotation();
  };
  const IntegratedTop::Matrix wanted = integrated(start.omega);
  Real change = 0;
  for (int i = 0; i < 3; ++i) {
    Vector3d omega = start.omega;
    omega[i] *= 1 + 0x1p-52;
    change = std::max(change, (integrated(omega) - wanted).cwiseAbs().maxCoeff());
  }
  const double tolerance = 2e-15 * (1 + start.omega.norm() * std::abs(t)) + 4 * static_cast<double>(change);
  EXPECT_LE(difference(start.top().rotation(t), wanted), tolerance) << "omega " << start.omega.transpose();
}

// Body axes along the world's: the components that matter are exact.
TEST(FreeTop, NearTheUnstableAxisIsAsGoodAsOmegaIsKnown) {
  ed::Random random(72);
  for (int k = 0; k < 12; ++k) {
    Start start;
    start.inertia = {0.5, 1, 1.2};
    const double distance = log_uniform(random, k % 3 == 0 ? 1e-130 : 1e-20, 1e-2);
    start.omega = distance * random.normal3();
    start.omega.y() = k % 2 == 0 ? -1 : 1;
    // The distance grows as exp(0.408 t); integration is right until about the second flip.
    const double escape = -std::log(distance) / 0.408;
    expect_as_good_as_omega(start, 0.7 * escape);
    expect_as_good_as_omega(start, (k % 4 < 2 ? 1 : -1) * (escape + 10));
  }
}

TEST(FreeTop, NearTheSeparatrixIsAsGoodAsOmegaIsKnown) {
  ed::Random random(73);
  for (int k = 0; k < 20; ++k) {
    Start start;
    const double low = log_uniform(random, 0.1, 1);
    const double middle = low * (1 + random.uniform());
    const double high = middle + low * random.uniform();
    start.inertia = {low, middle, high};
    start.omega = random.normal3();
    start.omega.z() = std::sqrt(low * (middle - low) / (high * (high - middle))) * start.omega.x() *
                      (1 + (k % 2 == 0 ? 1 : -1) * log_uniform(random, 1e-17, 1e-2));
    for (const double t : {1.0, -10.0, 50.0}) expect_as_good_as_omega(start, t / start.omega.norm());
  }
}

TEST(FreeTop, OnTheSeparatrixTendsToTheMiddleAxis) {
  // 2 E I2 = L^2 exactly: 1 * (2 - 1) * 3 = 3 * (3 - 2) * 1.
  Start start;
  start.inertia = {1, 2, 3};
  start.omega = {std::sqrt(3.0), 0, 1};
  const double rate = start.omega.norm();
  for (const double t : {5.0, 10.0, -10.0}) {
    IntegratedTop wanted(start.inertia, start.rotation, start.omega);
    wanted.advance(t);
    const TopState there = start.top().at(t);
    // The square root of 3 is rounded: by 1e-16, which grows as exp(0.8 t) to 1e-13 at most.
    EXPECT_LE(difference(there.R, wanted.rotation()), 1e-12);
    EXPECT_LE((there.R.col(1) * rate).cross(there.omega).norm(), 20 * rate * std::exp(-0.8 * std::abs(t)));
  }
}

TEST(FreeTop, StaysNearAStableAxis) {
  ed::Random random(74);
  for (int k = 0; k < 100; ++k) {
    Start start;
    start.inertia = {0.5, 1, 1.2};
    const int axis = k % 2 == 0 ? 0 : 2;
    const double distance = log_uniform(random, 1e-160, 1e-3);
    start.omega = distance * random.normal3();
    start.omega[axis] = 1;
    const TopState there = start.top().at(30 * random.normal());
    const Vector3d w = there.R.transpose() * there.omega;
    for (int i = 0; i < 3; ++i) {
      if (i == axis) continue;
      EXPECT_LE(std::abs(w[i]), 20 * distance + 1e-15);
    }
    IntegratedTop wanted(start.inertia, start.rotation, start.omega);
    wanted.advance(20);
    EXPECT_LE(difference(start.top().rotation(20), wanted.rotation()), 2e-14);
  }
}

/// Compares two moments that agree with moments that nearly do: nothing jumps where the formulas change.
TEST(FreeTop, KindsAgreeWhereTheyMeet) {
  ed::Random random(75);
  for (int k = 0; k < 1000; ++k) {
    const Vector3d inertia(1, 1, 0.2 + 1.7 * random.uniform());
    const Start exact = with_rotation(random, k % 2 == 0 ? inertia : Vector3d(1, 1, 1));
    const double t = 5 * random.normal();
    for (const double difference : {1e-15, 1e-12, 1e-9}) {
      Start near = exact;
      near.inertia[k % 3] += difference;
      near.inertia[(k + 1) % 3] -= difference;
      const double tolerance =
          5e-15 * (1 + 5 * exact.omega.norm()) + 100 * difference * (1 + exact.omega.norm() * std::abs(t));
      EXPECT_LE((near.top().rotation(t) - exact.top().rotation(t)).cwiseAbs().maxCoeff(), tolerance);
      EXPECT_LE((near.top().turned(t).world - exact.top().turned(t).world).norm(), 10 * tolerance);
      EXPECT_LE((near.top().turned(t).body - exact.top().turned(t).body).norm(), 10 * tolerance);
    }
  }
}

}  // namespace
