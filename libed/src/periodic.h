#pragma once

#include <Eigen/Core>

namespace ed::internal {

/// Rounds to the nearest integer, |x| < 2^51, without the function call that baseline x86-64 needs for it.
inline double nearest_integer(double x) {
  constexpr double kShift = 6755399441055744.0;  // 1.5 * 2^52
  return (x + kShift) - kShift;
}

inline Eigen::Vector3d nearest_image(const Eigen::Vector3d& d, double box) {
  const double inverse = 1 / box;
  return {d.x() - box * nearest_integer(d.x() * inverse), d.y() - box * nearest_integer(d.y() * inverse),
          d.z() - box * nearest_integer(d.z() * inverse)};
}

}  // namespace ed::internal
