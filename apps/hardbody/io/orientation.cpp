#include "io/orientation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace hardbody {

JsonOrientation read_quaternion(const std::array<double, 4>& q, const Eigen::Vector3d& position) {
  const auto [w, x, y, z] = q;
  const double length = Eigen::Vector4d(q.data()).norm();
  const double off = std::abs(length - 1);
  if (!(off <= kQuaternionTolerance)) {
    throw std::invalid_argument(
        fmt::format("quaternion (w, x, y, z) is not of length 1: its length is {:.6g}; accepted: 1 within {:g}", length,
                    kQuaternionTolerance));
  }
  // A pose takes the quaternion as it is where it can, for the same bits as geom gives.
  if (off <= kJsonRounding) return {geom::Pose::from_quaternion(w, x, y, z, position), length, false};
  return {geom::Pose::from_quaternion(w / length, x / length, y / length, z / length, position), length, true};
}

std::optional<Eigen::Matrix3d> FrameOrientations::rotation(const Eigen::Vector4d& q) {
  const double length = q.norm();
  const double off = std::abs(length - 1);
  if (!(off <= kQuaternionTolerance)) return std::nullopt;
  if (off > kFrameRounding) {
    ++normalized_;
    farthest_ = std::max(farthest_, off);
  }
  return geom::Pose::from_quaternion(q[0] / length, q[1] / length, q[2] / length, q[3] / length).rotation();
}

std::optional<std::string> FrameOrientations::notice() const {
  if (normalized_ == 0) return std::nullopt;
  return fmt::format("orientations: quaternions of {} bodies normalized, their lengths off 1 by up to {:.1e}",
                     normalized_, farthest_);
}

std::string FrameOrientations::fault(const Eigen::Vector4d& q) {
  return fmt::format("is a quaternion of length {:g}", q.norm());
}

std::string FrameOrientations::accepted() {
  return fmt::format("a length of 1 within {:g}", kQuaternionTolerance);
}

}  // namespace hardbody
