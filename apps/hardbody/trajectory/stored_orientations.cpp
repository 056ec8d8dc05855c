#include "trajectory/stored_orientations.h"

#include "io/orientation.h"

#include <geom/pose.h>

#include <fmt/format.h>

#include <algorithm>

namespace hardbody {

std::optional<Eigen::Matrix3d> StoredOrientations::rotation(const Eigen::Vector4d& q) {
  const QuaternionLength found(q);
  if (!found.accepted) return std::nullopt;
  if (found.normalized) {
    ++normalized_;
    farthest_ = std::max(farthest_, found.off);
  }
  const double length = found.length;
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
