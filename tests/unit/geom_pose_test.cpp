/// Pose: what is refused, what is corrected, and the conventions.

#include "common/geom_random.h"
#include "common/special_values.h"

#include <geom/geom.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;
using testing::AllOf;
using testing::HasSubstr;

/// The message of the std::invalid_argument that `make` throws.
template <class Make>
std::string refusal(const Make& make) {
  try {
    static_cast<void>(make());
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

double orthonormality_error(const Matrix3d& R) {
  return (R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

TEST(Pose, DefaultIsTheIdentity) {
  const Pose X;
  EXPECT_EQ(X.rotation(), Matrix3d::Identity());
  EXPECT_EQ(X.position(), Vector3d::Zero());
  const Pose shifted = Pose::translation({1, 2, 3});
  EXPECT_EQ(shifted.rotation(), Matrix3d::Identity());
  EXPECT_EQ(shifted.to_world({1, 0, 0}), Vector3d(2, 2, 3));
}

TEST(Pose, ColumnsOfTheRotationAreTheBodysAxesInTheWorld) {
  const double half = std::numbers::pi / 4;  // half of a quarter turn about z: body x points along world y
  const Pose X = Pose::from_quaternion(std::cos(half), 0, 0, std::sin(half), {10, 0, 0});
  EXPECT_LE((X.to_world({1, 0, 0}) - Vector3d(10, 1, 0)).norm(), 1e-15 * 10);
  EXPECT_LE((X.rotation().col(0) - Vector3d(0, 1, 0)).norm(), 1e-15);
}

TEST(Pose, FromQuaternionAgreesWithEigen) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d axis = random.direction();
    const Eigen::Quaterniond q(Eigen::AngleAxisd(random.uniform(-4, 4), axis));
    const Pose X = Pose::from_quaternion(q.w(), q.x(), q.y(), q.z());
    // A few roundings of numbers up to 1.
    ASSERT_LE((X.rotation() - q.toRotationMatrix()).cwiseAbs().maxCoeff(), 2e-15);
    ASSERT_LE(orthonormality_error(X.rotation()), 2e-15);
  }
}

TEST(Pose, ToBodyUndoesToWorld) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Pose X = random.pose(100.0);
    const Vector3d p = 10 * random.direction();
    // Coordinates up to 110 are added and taken away again.
    ASSERT_LE((X.to_body(X.to_world(p)) - p).norm(), 1e-13);
    ASSERT_NEAR((X.to_world(p) - X.to_world(-p)).norm(), 20, 1e-13);
  }
}

TEST(Pose, RefusesPositionsThatAreNotFinite) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vector3d position(1, 2, 3);
      position[axis] = bad;
      const auto wanted =
          AllOf(HasSubstr("position"), HasSubstr("accepted: three finite numbers, none beyond +-1e100"));
      ASSERT_THAT(refusal([&] { return Pose(Matrix3d::Identity(), position); }), wanted);
      ASSERT_THAT(refusal([&] { return Pose::translation(position); }), wanted);
      ASSERT_THAT(refusal([&] { return Pose::from_quaternion(1, 0, 0, 0, position); }), wanted);
    }
  }
}

TEST(Pose, RefusesRotationsThatAreNotFinite) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (int entry = 0; entry < 9; ++entry) {
      Matrix3d R = Matrix3d::Identity();
      R(entry / 3, entry % 3) = bad;
      ASSERT_THAT(refusal([&] { return Pose(R, Vector3d::Zero()); }), HasSubstr("rotation is not orthonormal"));
    }
  }
}

TEST(Pose, RefusesReflections) {
  const Matrix3d mirror = Vector3d(1, 1, -1).asDiagonal();
  EXPECT_THAT(refusal([&] { return Pose(mirror, Vector3d::Zero()); }),
              AllOf(HasSubstr("reflection"), HasSubstr("(-1)"), HasSubstr("accepted: +1")));
}

TEST(Pose, RefusesRotationsBeyondTheToleranceAndTakesThoseWithin) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Matrix3d R = random.pose(0.0).rotation();
    // Stretched by 1 + s, R^T R - 1 is 2s + s^2 on the diagonal.
    ASSERT_THAT(refusal([&] { return Pose(R * (1 + 0.51e-6), Vector3d::Zero()); }),
                AllOf(HasSubstr("rotation is not orthonormal"), HasSubstr("accepted: at most 1e-6")));
    ASSERT_EQ(refusal([&] { return Pose(R * (1 + 0.49e-6), Vector3d::Zero()); }), "accepted");
  }
  EXPECT_THAT(refusal([] { return Pose(Matrix3d::Zero(), Vector3d::Zero()); }), HasSubstr("not orthonormal"));
  EXPECT_THAT(refusal([] { return Pose(Matrix3d::Ones(), Vector3d::Zero()); }), HasSubstr("not orthonormal"));
}

TEST(Pose, ARotationWithinTheToleranceIsReplacedByTheNearestOrthonormalOne) {
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const Matrix3d R = random.pose(0.0).rotation();
    // R (1 + S) with S symmetric: its polar decomposition is R itself. Entries of S below 0.4e-6 keep R^T R - 1, 2 S
    // nearly, within the tolerance.
    Matrix3d S;
    for (int entry = 0; entry < 9; ++entry) S(entry / 3, entry % 3) = random.uniform(-0.4e-6, 0.4e-6);
    S = (0.5 * (S + S.transpose())).eval();
    const Pose X(R + R * S, Vector3d::Zero());
    // Rounding of a few products of numbers up to 1, and the 1.1e-16 by which R itself errs.
    ASSERT_LE(orthonormality_error(X.rotation()), 2e-15);
    ASSERT_LE((X.rotation() - R).cwiseAbs().maxCoeff(), 3e-15);
  }
}

TEST(Pose, AQuaternionWithinTheToleranceIsNormalised) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Quaterniond q(Eigen::AngleAxisd(random.uniform(-3, 3), random.direction()));
    const double length = 1 + random.uniform(-0.99e-6, 0.99e-6);
    const Pose X = Pose::from_quaternion(length * q.w(), length * q.x(), length * q.y(), length * q.z());
    ASSERT_LE((X.rotation() - q.toRotationMatrix()).cwiseAbs().maxCoeff(), 3e-15);
  }
}

TEST(Pose, RefusesQuaternionsThatAreNotOfLengthOne) {
  const auto wanted = AllOf(HasSubstr("quaternion"), HasSubstr("accepted: 1 within 1e-6"));
  for (const double w : {0.0, 2.0, 1 + 1.01e-6, 1 - 1.01e-6, 1e200, kNaN, kInfinity}) {
    ASSERT_THAT(refusal([&] { return Pose::from_quaternion(w, 0, 0, 0); }), wanted) << w;
    ASSERT_THAT(refusal([&] { return Pose::from_quaternion(0, 0, w, 0); }), wanted) << w;
  }
}

}  // namespace
}  // namespace geom
