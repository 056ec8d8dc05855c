/// Pose: what is refused, what is corrected, and the conventions.

#include "common/geom/random.h"
#include "common/special_values.h"

#include <geom/geom.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <cmath>
#include <limits>
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

// ---- Quaternions of any length ------------------------------------------------------------------------------------

using Real = long double;
using ExactMatrix = Eigen::Matrix<Real, 3, 3>;
using ExactVector = Eigen::Matrix<Real, 3, 1>;

/// The rotation of q / |q| in long double.
ExactMatrix exact_rotation(double w, double x, double y, double z) {
  const auto exact = [](double number) { return static_cast<Real>(number); };
  return Eigen::Quaternion<Real>(exact(w), exact(x), exact(y), exact(z)).normalized().toRotationMatrix();
}

double largest_difference(const Matrix3d& R, const ExactMatrix& exact) {
  return static_cast<double>((R.cast<Real>() - exact).cwiseAbs().maxCoeff());
}

TEST(Pose, NormalizedQuaternionTakesAnyLength) {
  Random random(6);
  for (int i = 0; i < 3000; ++i) {
    const Vector3d n = random.log_uniform(1e-12, 1) * random.direction();
    const double length = random.log_uniform(1e-150, 1e150);
    const double w = length * random.uniform(-1, 1);
    const Vector3d v = length * n;
    const Pose X = Pose::normalized_quaternion(w, v.x(), v.y(), v.z(), {1, 2, 3});
    ASSERT_LE(
        largest_difference(X.rotation(), exact_rotation(w / length, v.x() / length, v.y() / length, v.z() / length)),
        1e-15);
    ASSERT_LE(orthonormality_error(X.rotation()), 2e-15);
    ASSERT_EQ(X.position(), Vector3d(1, 2, 3));
  }
}

TEST(Pose, NormalizedQuaternionTakesTheSmallestAndTheLargestNumbers) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  const double huge = std::numeric_limits<double>::max();
  EXPECT_EQ(Pose::normalized_quaternion(-3, 0, 0, 0).rotation(), Matrix3d::Identity());
  for (const double length : {tiny, 1e-310, huge}) {
    EXPECT_EQ(Pose::normalized_quaternion(length, 0, 0, 0).rotation(), Matrix3d::Identity());
    // Half a turn about (1, 1, 0).
    const Matrix3d swap = Pose::normalized_quaternion(0, length, length, 0).rotation();
    EXPECT_LE((swap * Vector3d(1, 0, 0) - Vector3d(0, 1, 0)).norm(), 1e-15);
  }
  EXPECT_EQ(Pose::normalized_quaternion(1, tiny, 0, 0).rotation().row(0), Matrix3d::Identity().row(0));
}

TEST(Pose, NormalizedQuaternionRefusesZeroAndWhatIsNotFinite) {
  EXPECT_THAT(refusal([] { return Pose::normalized_quaternion(0, 0, 0, -0.0); }),
              AllOf(HasSubstr("zero"), HasSubstr("accepted: four finite numbers, not all of them 0")));
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (int k = 0; k < 4; ++k) {
      double q[4] = {1, 1, 1, 1};
      q[k] = bad;
      ASSERT_THAT(refusal([&] { return Pose::normalized_quaternion(q[0], q[1], q[2], q[3]); }),
                  AllOf(HasSubstr("not finite"), HasSubstr("accepted: four finite numbers")));
    }
  }
  EXPECT_THAT(refusal([] { return Pose::normalized_quaternion(1, 0, 0, 0, {kNaN, 0, 0}); }), HasSubstr("position"));
}

// ---- Eigen's types ------------------------------------------------------------------------------------------------

TEST(Pose, QuaternionsOfEigenGoInAndOut) {
  Random random(7);
  for (int i = 0; i < 3000; ++i) {
    // Small turns and nearly half turns too: every branch of the way back.
    const double angle = i % 3 == 0   ? random.log_uniform(1e-12, 1)
                         : i % 3 == 1 ? std::numbers::pi
                                      : random.uniform(-4, 4);
    const Vector3d axis = i % 2 == 0 ? random.direction() : Vector3d(Vector3d::Unit(i % 6 / 2));
    const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, axis));
    const Pose X = Pose::from_quaternion(q, {1, 2, 3});
    ASSERT_EQ(X.rotation(), Pose::from_quaternion(q.w(), q.x(), q.y(), q.z()).rotation());
    const Eigen::Quaterniond back = X.quaternion();
    ASSERT_NEAR(back.norm(), 1, 4e-16);
    ASSERT_GE(back.w(), 0);
    const double sign = back.coeffs().dot(q.coeffs()) < 0 ? -1 : 1;
    ASSERT_LE((sign * back.coeffs() - q.coeffs()).cwiseAbs().maxCoeff(), 1e-15);
    ASSERT_LE((Pose::from_quaternion(back).rotation() - X.rotation()).cwiseAbs().maxCoeff(), 3e-15);
    ASSERT_LE((Pose::normalized_quaternion(q.cast<float>()).rotation() - X.rotation()).cwiseAbs().maxCoeff(), 1e-6);
  }
  const Eigen::Quaternion<double, Eigen::DontAlign> unaligned = Pose().quaternion<Eigen::DontAlign>();
  EXPECT_EQ(unaligned.w(), 1);
}

TEST(Pose, IsometriesOfEigenGoInAndOutToTheLastBit) {
  Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const Pose X = random.pose(10.0);
    const Eigen::Isometry3d T = X.isometry();
    const Vector3d p = random.direction();
    ASSERT_LE((T * p - X.to_world(p)).norm(), 1e-14);
    ASSERT_EQ(T.linear(), X.rotation());
    ASSERT_EQ(T.translation(), X.position());
    ASSERT_EQ(T.matrix().row(3), Eigen::RowVector4d(0, 0, 0, 1));
    const Pose back = Pose::from_isometry(T);
    // What is orthonormal to 1e-15 is taken as it is; the rest is improved, by rounding.
    ASSERT_LE((back.rotation() - X.rotation()).cwiseAbs().maxCoeff(), 2e-15);
    ASSERT_EQ(back.position(), X.position());
  }
  Eigen::Isometry3d sheared = Eigen::Isometry3d::Identity();
  sheared.linear()(0, 1) = 0.1;
  EXPECT_THAT(refusal([&] { return Pose::from_isometry(sheared); }), HasSubstr("not orthonormal"));
}

// ---- The nearest rotation -----------------------------------------------------------------------------------------

TEST(Pose, NearestRotationIsThePolarFactor) {
  Random random(9);
  for (int i = 0; i < 2000; ++i) {
    const Matrix3d R = random.pose(0.0).rotation();
    // R (1 + S) with S symmetric: its polar factor is R.
    const double size = random.log_uniform(1e-12, 3e-3);
    Matrix3d S;
    for (int entry = 0; entry < 9; ++entry) S(entry / 3, entry % 3) = random.uniform(-size, size);
    S = (0.5 * (S + S.transpose())).eval();
    const ExactMatrix matrix = R.cast<Real>() * (ExactMatrix::Identity() + S.cast<Real>());
    const Pose X = Pose::nearest_rotation(matrix.cast<double>(), {1, 2, 3});
    ASSERT_LE((X.rotation() - R).cwiseAbs().maxCoeff(), 3e-15);  // R errs by 1e-15 itself
    ASSERT_LE(orthonormality_error(X.rotation()), 2e-15);
    ASSERT_EQ(X.position(), Vector3d(1, 2, 3));
  }
}

/// Chains of 10,000 turns in single precision are accepted, and give the nearest rotation.
TEST(Pose, NearestRotationTakesChainsInSinglePrecision) {
  Random random(10);
  for (int chain = 0; chain < 20; ++chain) {
    Eigen::Isometry3f T = Eigen::Isometry3f::Identity();
    for (int i = 0; i < 10'000; ++i) {
      const Eigen::AngleAxisf turn(static_cast<float>(random.uniform(-3, 3)), random.direction().cast<float>());
      T = T * Eigen::Isometry3f(turn);
    }
    const Matrix3d drifted = T.linear().cast<double>();
    ASSERT_GT(orthonormality_error(drifted), 1e-6);
    ASSERT_LT(orthonormality_error(drifted), 0.1 * kNearestRotationTolerance);
    ASSERT_THAT(refusal([&] { return Pose(drifted, Vector3d::Zero()); }), HasSubstr("not orthonormal"));
    const Pose X = Pose::nearest_rotation(T);
    const Eigen::JacobiSVD<Matrix3d> svd(drifted, Eigen::ComputeFullU | Eigen::ComputeFullV);
    ASSERT_LE((X.rotation() - svd.matrixU() * svd.matrixV().transpose()).cwiseAbs().maxCoeff(), 5e-15);
  }
  EXPECT_EQ(Pose::nearest_rotation(Eigen::Affine3d(Eigen::Translation3d(1, 2, 3))).position(), Vector3d(1, 2, 3));
}

TEST(Pose, NearestRotationRefusesReflectionsAndWorse) {
  const auto accept = [](const Matrix3d& matrix) {
    return refusal([&] { return Pose::nearest_rotation(matrix, Vector3d::Zero()); });
  };
  const Matrix3d R = Random(11).pose(0.0).rotation();
  // R^T R - 1 of R (1 + s) is 2 s + s^2 on the diagonal.
  EXPECT_EQ(accept(R * (1 + 0.49e-2)), "accepted");
  EXPECT_EQ(accept(R * (1 - 0.5e-2)), "accepted");
  EXPECT_THAT(accept(R * (1 + 0.5e-2)), AllOf(HasSubstr("not orthonormal"), HasSubstr("accepted: at most 1e-2")));
  EXPECT_THAT(accept(-R), AllOf(HasSubstr("reflection"), HasSubstr("accepted: +1")));
  for (const Matrix3d& bad : {Matrix3d(Matrix3d::Zero()), Matrix3d(Matrix3d::Ones()), Matrix3d(2 * R)}) {
    EXPECT_THAT(accept(bad), HasSubstr("not orthonormal"));
  }
  Matrix3d holey = R;
  holey(1, 2) = kNaN;
  EXPECT_THAT(accept(holey), HasSubstr("not orthonormal"));
}

// ---- Composition and inverse --------------------------------------------------------------------------------------

TEST(Pose, CompositionIsOneMapAfterTheOther) {
  Random random(12);
  for (int i = 0; i < 2000; ++i) {
    const Pose X_WA = random.pose(random.log_uniform(1e-3, 1e3));
    const Pose X_AB = random.pose(random.log_uniform(1e-3, 1e3));
    const Pose X_WB = X_WA * X_AB;
    const ExactMatrix R = X_WA.rotation().cast<Real>() * X_AB.rotation().cast<Real>();
    ASSERT_LE(largest_difference(X_WB.rotation(), R), 2e-15);
    const ExactVector p = X_WA.rotation().cast<Real>() * X_AB.position().cast<Real>() + X_WA.position().cast<Real>();
    const double lengths = X_WA.position().norm() + X_AB.position().norm();
    ASSERT_LE(static_cast<double>((X_WB.position().cast<Real>() - p).cwiseAbs().maxCoeff()), 2e-15 * lengths);
  }
  EXPECT_EQ((Pose() * Pose::translation({1, 2, 3})).position(), Vector3d(1, 2, 3));
  EXPECT_THAT(refusal([] {
                return Pose::translation({1e100, 0, 0}) * Pose::translation({1e100, 0, 0});
              }),
              HasSubstr("position is too far away"));
}

TEST(Pose, ChainsStayOrthonormal) {
  Random random(13);
  Pose X;
  for (int i = 0; i < 100'000; ++i) {
    X = X * random.pose(1.0);
    ASSERT_LE(orthonormality_error(X.rotation()), 2e-15);
  }
}

TEST(Pose, InverseUndoesThePose) {
  Random random(14);
  for (int i = 0; i < 2000; ++i) {
    const Pose X = random.pose(random.log_uniform(1e-3, 1e3));
    const Pose inverse = X.inverse();
    ASSERT_EQ(inverse.rotation(), X.rotation().transpose());
    const ExactVector p = -(X.rotation().cast<Real>().transpose() * X.position().cast<Real>());
    const double length = X.position().norm();
    ASSERT_LE(static_cast<double>((inverse.position().cast<Real>() - p).cwiseAbs().maxCoeff()), 1e-15 * length);
    const Pose one = X * inverse;
    ASSERT_LE((one.rotation() - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 3e-15);
    ASSERT_LE(one.position().norm(), 4e-15 * length);
  }
}

}  // namespace
}  // namespace geom
