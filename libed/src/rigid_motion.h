#pragma once

/// The free motion of any rigid body between two events.

#include "free_top.h"

#include <Eigen/Core>

namespace ed::internal {

/// Uniform motion of the centre and free rotation about it; position and orientation at `time`.
struct RigidMotion {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  FreeTop top;
  double time = 0;

  Eigen::Vector3d position_at(double t) const { return position + (t - time) * velocity; }
};

}  // namespace ed::internal
