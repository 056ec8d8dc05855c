#include "shapes/format.h"

#include <geom/kernel/refuse.h>
#include <geom/pose.h>
#include <geom/tolerances.h>

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

namespace geom {
namespace {

[[noreturn]] void refuse(const char* what, double value, const char* accepted) {
  kernel::refuse(std::string("Pose: ") + what + " (" + kernel::shown(value) + "); accepted: " + accepted);
}

void check_position(const Eigen::Vector3d& position) {
  constexpr const char* kAccepted = "three finite numbers, none beyond +-1e100";
  static_assert(kMaxCoordinate == 1e100);
  for (const double x : {position.x(), position.y(), position.z()}) {
    if (!std::isfinite(x)) refuse("position is not finite", x, kAccepted);
    if (std::abs(x) > kMaxCoordinate) refuse("position is too far away", x, kAccepted);
  }
}

/// Returns the largest entry of R^T R - 1; NaN if an entry of R is NaN.
double orthonormality_error(const Eigen::Matrix3d& R) {
  const Eigen::Matrix3d excess = R.transpose() * R - Eigen::Matrix3d::Identity();
  return excess.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
}

/// Returns that error or throws if it is above `tolerance`; `accepted`: the tolerance in words.
double checked_orthonormality_error(const Eigen::Matrix3d& R, double tolerance, const char* accepted) {
  const double error = orthonormality_error(R);
  if (!(error <= tolerance)) refuse("rotation is not orthonormal: largest entry of R^T R - 1", error, accepted);
  if (!(R.determinant() > 0)) refuse("rotation is a reflection: determinant", R.determinant(), "+1");
  return error;
}

/// Returns the result of a step of Newton's iteration for the polar decomposition, which squares the error of R^T R.
Eigen::Matrix3d towards_polar_factor(const Eigen::Matrix3d& R) {
  return R * (1.5 * Eigen::Matrix3d::Identity() - 0.5 * R.transpose() * R);
}

/// Error of R^T R at which the iteration ends: a few roundings.
constexpr double kOrthonormal = 1e-15;

/// Number of steps that reduce an error of kNearestRotationTolerance to rounding, plus one. A matrix whose entries are
/// at most 1e-2 has a norm of at most 3e-2, and a step changes the norm e to at most e^2: 9e-4, 8.1e-7, 6.6e-13,
/// rounding.
constexpr int kPolarSteps = 5;

/// Returns the rotation of a quaternion; |q|^2 must be between 0.25 and 4.
Eigen::Matrix3d rotation_of(double w, double x, double y, double z) {
  const double s = 2 / (w * w + x * x + y * y + z * z);
  Eigen::Matrix3d R;
  R << 1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y),  //
      s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x),   //
      s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y);
  return R;
}

}  // namespace

Pose::Pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position)
    : rotation_(rotation), position_(position) {
  check_position(position);
  if (checked_orthonormality_error(rotation, kPoseTolerance, "at most 1e-6") <= kOrthonormal) return;
  // Two steps reduce 1e-6 to rounding.
  for (int step = 0; step < 2; ++step) rotation_ = towards_polar_factor(rotation_);
}

Pose Pose::translation(const Eigen::Vector3d& position) {
  return {Eigen::Matrix3d::Identity(), position};
}

Pose Pose::from_quaternion(double w, double x, double y, double z, const Eigen::Vector3d& position) {
  const double norm = std::sqrt(w * w + x * x + y * y + z * z);
  if (!(std::abs(norm - 1) <= kPoseTolerance)) {
    refuse("quaternion (w, x, y, z) is not of length 1: its length", norm, "1 within 1e-6");
  }
  w /= norm;
  x /= norm;
  y /= norm;
  z /= norm;
  Eigen::Matrix3d R;
  R << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
      2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
      2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
  return {R, position};
}

Pose Pose::normalized_quaternion(double w, double x, double y, double z, const Eigen::Vector3d& position) {
  constexpr const char* kAccepted = "four finite numbers, not all of them 0";
  double largest = 0;
  for (const double component : {w, x, y, z}) {
    if (!std::isfinite(component)) refuse("quaternion (w, x, y, z) is not finite", component, kAccepted);
    largest = std::max(largest, std::abs(component));
  }
  if (!(largest > 0)) refuse("quaternion (w, x, y, z) is zero: largest component", largest, kAccepted);
  int exponent = 0;
  std::frexp(largest, &exponent);
  // Scaled by a power of two: exact.
  const auto scaled = [&](double component) { return std::ldexp(component, -exponent); };
  return {rotation_of(scaled(w), scaled(x), scaled(y), scaled(z)), position};
}

Pose Pose::nearest_rotation(const Eigen::Matrix3d& matrix, const Eigen::Vector3d& position) {
  double error = checked_orthonormality_error(matrix, kNearestRotationTolerance, "at most 1e-2");
  Eigen::Matrix3d R = matrix;
  for (int step = 0; step < kPolarSteps && error > kOrthonormal; ++step) {
    R = towards_polar_factor(R);
    error = orthonormality_error(R);
  }
  return {R, position};
}

Pose Pose::operator*(const Pose& X_BC) const {
  return {rotation_ * X_BC.rotation_, to_world(X_BC.position_)};
}

Pose Pose::inverse() const {
  Pose inverse = translation(-(rotation_.transpose() * position_));
  inverse.rotation_ = rotation_.transpose();
  return inverse;
}

std::array<double, 4> kernel::quaternion_of(const Eigen::Matrix3d& R) {
  // 4 q q^T has these squares on its diagonal; the largest is at least 1 (Shepperd, J. Guid. Control 1 (1978) 223).
  const double trace = R.trace();
  const std::array<double, 4> squares = {1 + trace, 1 + 2 * R(0, 0) - trace, 1 + 2 * R(1, 1) - trace,
                                         1 + 2 * R(2, 2) - trace};
  const auto largest = std::max_element(squares.begin(), squares.end()) - squares.begin();
  Eigen::Matrix<double, 4, 1, Eigen::DontAlign> q;  // a row of 4 q q^T
  if (largest == 0) {
    q << squares[0], R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1);
  } else {
    const auto i = largest - 1;
    const auto j = (i + 1) % 3;
    const auto k = (i + 2) % 3;
    q[0] = R(k, j) - R(j, k);
    q[1 + i] = squares[static_cast<std::size_t>(largest)];
    q[1 + j] = R(j, i) + R(i, j);
    q[1 + k] = R(k, i) + R(i, k);
  }
  const double scale = (q[0] < 0 ? -1 : 1) / std::sqrt(q.squaredNorm());
  return {scale * q[0], scale * q[1], scale * q[2], scale * q[3]};
}

}  // namespace geom
