#pragma once

/// Free motion of any rigid body between two events.

#include "motion/free_top.h"

#include <Eigen/Core>

#include <cmath>

namespace ed::internal {

/// Uniform motion of the centre and free rotation about it; position and orientation at `time`.
struct RigidMotion {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  FreeTop top;
  double time = 0;

  Eigen::Vector3d position_at(double t) const { return position + (t - time) * velocity; }
};

template <class Archive, Is<RigidMotion> T>
void fields(Archive& archive, T& m) {
  archive(m.position, m.velocity, m.top, m.time);
  expect(archive, (m.position + m.velocity).allFinite() && std::isfinite(m.time), "a motion is not finite");
}

/// Contact points of two bodies, each from its own centre.
struct ContactPoints {
  Eigen::Vector3d a, b;
};

}  // namespace ed::internal
