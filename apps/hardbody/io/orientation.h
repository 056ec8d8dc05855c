#pragma once

#include <geom/pose.h>

#include <Eigen/Core>

#include <array>

namespace hardbody {

/// Largest difference from 1 of a quaternion's length that is accepted in a file or a query: for numbers of six digits
/// or 32 bits, or integrated by another program. The quaternion is then normalised; if the difference is more than
/// rounding, geom::kPoseTolerance, a notice says so. Any other is refused.
inline constexpr double kQuaternionTolerance = 1e-3;

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
