#pragma once

#include <geom/kernel/eigen_layout.h>

#include <Eigen/Core>

#include <vector>

namespace ed {

/// State of all bodies at one time, as the observables need it.
struct Snapshot {
  double time = 0;
  std::vector<Eigen::Vector3d> position;  ///< unwrapped positions: continuous across the box's faces
  std::vector<Eigen::Vector3d> axis;      ///< unit axes of revolution (for bodies without one: body z)
  /// Rotations, body to world. Empty if all bodies are of revolution and of the fast case (Simulation).
  std::vector<Eigen::Matrix3d> rotation;
  std::vector<Eigen::Vector3d> phi_lab;   ///< integral of omega (spin excluded), world frame, since the start
  std::vector<Eigen::Vector3d> phi_body;  ///< integral of omega with its components along the body's own axes
  std::vector<Eigen::Vector3d> velocity;
  std::vector<Eigen::Vector3d> angular_velocity;  ///< angular velocities, spin excluded, world frame
};

}  // namespace ed
