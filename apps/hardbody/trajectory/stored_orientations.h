#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <string>

namespace hardbody {

/// Rotations of the quaternions of one frame, whose lengths a file gives as 1 but for rounding. Lengths off by up to
/// kQuaternionTolerance are normalized, and beyond rounding counted for a notice.
class StoredOrientations {
 public:
  /// Body to world, from w, x, y, z; nothing if the length is not 1 within the tolerance.
  std::optional<Eigen::Matrix3d> rotation(const Eigen::Vector4d& q);
  /// Line about those that were normalized; nothing if none was.
  std::optional<std::string> notice() const;
  /// Words of a message: the fault of a quaternion that has no rotation, and what would be accepted.
  static std::string fault(const Eigen::Vector4d& q);
  static std::string accepted();

 private:
  std::size_t normalized_ = 0;
  double farthest_ = 0;
};

}  // namespace hardbody
