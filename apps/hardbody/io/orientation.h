#pragma once

#include <geom/pose.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>
#include <string>

namespace hardbody {

/// Largest difference from 1 of a quaternion's length that is accepted in a file or a query. The quaternion is then
/// normalised, and a notice says so if the difference exceeds kJsonRounding or kFrameRounding. Any other is refused.
inline constexpr double kQuaternionTolerance = 1e-3;
/// Difference from 1 of a quaternion's length in JSON that counts as rounding and gives no notice: such quaternions a
/// geom::Pose takes as they are.
inline constexpr double kJsonRounding = geom::kPoseTolerance;
/// Difference from 1 of a quaternion's length in a frame of a trajectory that counts as rounding, of 32-bit numbers or
/// of six digits, and gives no notice.
inline constexpr double kFrameRounding = 1e-5;

/// Orientation in JSON: a query, or a file of a pair.
struct JsonOrientation {
  geom::Pose pose;
  double length = 1;        ///< length of the quaternion
  bool normalized = false;  ///< whether the length differs from 1 by more than kJsonRounding
};

/// Reads a quaternion (w, x, y, z), body to world. Throws std::invalid_argument, naming the length, if that differs
/// from 1 by more than kQuaternionTolerance.
JsonOrientation read_quaternion(const std::array<double, 4>& q,
                                const Eigen::Vector3d& position = Eigen::Vector3d::Zero());

/// Rotations from the quaternions of one frame. Quaternions whose lengths differ from 1 by up to kQuaternionTolerance
/// are normalised, and if the difference exceeds kFrameRounding, counted for a notice.
class FrameOrientations {
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
