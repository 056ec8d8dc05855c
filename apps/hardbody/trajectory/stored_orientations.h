#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <string>

namespace hardbody {

/// Rotations from the quaternions of one frame. Quaternions whose lengths differ from 1 by up to kQuaternionTolerance
/// are normalised, and if the difference is more than rounding, counted for a notice.
class StoredOrientations {
 public:
  /// Returns the rotation, body to world, from w, x, y, z; nullopt if the length is not 1 within the tolerance.
  std::optional<Eigen::Matrix3d> rotation(const Eigen::Vector4d& q);
  /// Returns a line about those that were normalised; nullopt if none was.
  std::optional<std::string> notice() const;
  /// Returns the words of a message: the fault of a quaternion that has no rotation, and what would be accepted.
  static std::string fault(const Eigen::Vector4d& q);
  static std::string accepted();

 private:
  std::size_t normalized_ = 0;
  double farthest_ = 0;
};

}  // namespace hardbody
