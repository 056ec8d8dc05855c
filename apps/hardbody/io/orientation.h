#pragma once

#include <geom/pose.h>

#include <Eigen/Core>

#include <array>

namespace hardbody {

/// A quaternion in a file or a query may be of a length that differs from 1 by at most this: numbers of six digits or
/// 32 bits, or integrated by another program. It is then made a unit quaternion, which a notice says where it is off by
/// more than kQuaternionRounding; any other is refused.
inline constexpr double kQuaternionTolerance = 1e-3;
/// Deviation of a quaternion's length from 1 that is rounding, of 32-bit numbers or of six digits, and not worth a
/// notice.
inline constexpr double kQuaternionRounding = 1e-5;

/// Length of a quaternion in a file or a query, and what is done with it.
struct QuaternionLength {
  explicit QuaternionLength(const Eigen::Vector4d& q);

  double length;    ///< |q|
  double off;       ///< | |q| - 1 |
  bool accepted;    ///< within kQuaternionTolerance of 1
  bool normalized;  ///< off by more than rounding: a notice says so
};

/// Orientation as a file or a query has it.
struct StoredOrientation {
  geom::Pose pose;
  double length = 1;        ///< of the quaternion
  bool normalized = false;  ///< the length is off by more than rounding
};

/// Reads a quaternion (w, x, y, z), body to world. Throws std::invalid_argument, naming the length, if that is further
/// than kQuaternionTolerance from 1.
StoredOrientation read_quaternion(const std::array<double, 4>& q,
                                  const Eigen::Vector3d& position = Eigen::Vector3d::Zero());

}  // namespace hardbody
