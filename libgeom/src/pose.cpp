#include "shown.h"

#include <geom/pose.h>
#include <geom/tolerances.h>

#include <Eigen/LU>

#include <cmath>
#include <stdexcept>
#include <string>

namespace geom {
namespace {

[[noreturn]] void refuse(const char* what, double value, const char* accepted) {
  throw std::invalid_argument(std::string("Pose: ") + what + " (" + internal::shown(value) +
                              "); accepted: " + accepted);
}

void check_position(const Eigen::Vector3d& position) {
  constexpr const char* kAccepted = "three finite numbers, none beyond +-1e100";
  static_assert(kMaxCoordinate == 1e100);
  for (const double x : {position.x(), position.y(), position.z()}) {
    if (!std::isfinite(x)) refuse("position is not finite", x, kAccepted);
    if (std::abs(x) > kMaxCoordinate) refuse("position is too far away", x, kAccepted);
  }
}

}  // namespace

Pose::Pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position)
    : rotation_(rotation), position_(position) {
  check_position(position);
  const Eigen::Matrix3d excess = rotation.transpose() * rotation - Eigen::Matrix3d::Identity();
  const double error = excess.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
  if (!(error <= kPoseTolerance)) {
    refuse("rotation is not orthonormal: largest entry of R^T R - 1", error, "at most 1e-6");
  }
  if (!(rotation.determinant() > 0)) {
    refuse("rotation is a reflection: determinant", rotation.determinant(), "+1");
  }
  if (error <= 1e-15) return;
  // Newton's iteration for the polar decomposition squares the error: two steps take 1e-6 to rounding.
  for (int step = 0; step < 2; ++step) {
    rotation_ = rotation_ * (1.5 * Eigen::Matrix3d::Identity() - 0.5 * rotation_.transpose() * rotation_);
  }
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

}  // namespace geom
