#pragma once

#include <geom/pose.h>

#include <Eigen/Core>

namespace geom::kernel {

/// Returns a pose with its position moved by a vector, without checks.
inline Pose moved(const Pose& X_WB, const Eigen::Vector3d& by) {
  return unchecked_pose(X_WB.rotation(), X_WB.position() + by);
}

}  // namespace geom::kernel
