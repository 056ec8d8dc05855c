#pragma once

#include "base/nearest_integer.h"

#include <Eigen/Core>

namespace ed::internal {

inline Eigen::Vector3d nearest_image(const Eigen::Vector3d& d, double box) {
  const double inverse = 1 / box;
  return {d.x() - box * nearest_integer(d.x() * inverse), d.y() - box * nearest_integer(d.y() * inverse),
          d.z() - box * nearest_integer(d.z() * inverse)};
}

}  // namespace ed::internal
