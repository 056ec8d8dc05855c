#pragma once

#include <geom/pose.h>

#include <Eigen/Core>

#include <array>

namespace hardbody {

/// Largest difference from 1 of a quaternion's length that is accepted in a file or a query: for numbers of six digits
/// or 32 bits, or integrated by another program. The quaternion is then normalised; if the difference is more than
/// kQuaternionRounding, a notice says so. Any other is refused.
inline constexpr double kQuaternionTolerance = 1e-3;
/// Deviation of a quaternion's length from 1 that counts as rounding, of 32-bit numbers or of six digits, and gives no
/// notice.
inline constexpr double kQuaternionRounding = 1e-5;

/// Length of a quaternion in a file or a query, and its classification.
struct QuaternionLength {
  explicit QuaternionLength(const Eigen::Vector4d& q);

  double length;    ///< |q|
  double off;       ///< | |q| - 1 |
  bool accepted;    ///< whether the length is 1 within kQuaternionTolerance
  bool normalized;  ///< whether the length is off by more than rounding, which gives a notice
};

/// Orientation as stored in a file or a query.
struct StoredOrientation {
  geom::Pose pose;
  double length = 1;        ///< length of the quaternion
  bool normalized = false;  ///< whether the length differs from 1 by more than rounding
};

/// Reads a quaternion (w, x, y, z), body to world. Throws std::invalid_argument, naming the length, if that differs
/// from 1 by more than kQuaternionTolerance.
StoredOrientation read_quaternion(const std::array<double, 4>& q,
                                  const Eigen::Vector3d& position = Eigen::Vector3d::Zero());

}  // namespace hardbody
