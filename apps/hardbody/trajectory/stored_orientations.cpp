#include "trajectory/stored_orientations.h"

#include "io/orientation.h"

#include <geom/pose.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hardbody {
namespace {

/// Deviation of a length from 1 that counts as rounding, of 32-bit numbers or of six digits, and gives no notice.
constexpr double kRoundedLength = 1e-5;

}  // namespace

std::optional<Eigen::Matrix3d> StoredOrientations::rotation(const Eigen::Vector4d& q) {
  const double length = q.norm();
  const double off = std::abs(length - 1);
  if (!(off <= kQuaternionTolerance)) return std::nullopt;
  if (off > kRoundedLength) {
    ++normalized_;
    farthest_ = std::max(farthest_, off);
  }
  return geom::Pose::from_quaternion(q[0] / length, q[1] / length, q[2] / length, q[3] / length).rotation();
}

std::optional<std::string> StoredOrientations::notice() const {
  if (normalized_ == 0) return std::nullopt;
  return fmt::format("orientations: quaternions of {} bodies normalized, their lengths off 1 by up to {:.1e}",
                     normalized_, farthest_);
}

std::string StoredOrientations::fault(const Eigen::Vector4d& q) {
  return fmt::format("is a quaternion of length {:g}", q.norm());
}

std::string StoredOrientations::accepted() {
  return fmt::format("a length of 1 within {:g}", kQuaternionTolerance);
}

}  // namespace hardbody
