#pragma once

#include <Eigen/Core>

#include <vector>

namespace ed {

/// All bodies at one time, as the observables want them.
struct Snapshot {
  double time = 0;
  std::vector<Eigen::Vector3d> position;  ///< unwrapped: continuous across the box's faces
  std::vector<Eigen::Vector3d> axis;      ///< of revolution (of bodies that have none: body z), unit
  /// Body to world. Empty where all bodies are ellipsoids of revolution that do not spin about their axes.
  std::vector<Eigen::Matrix3d> rotation;
  std::vector<Eigen::Vector3d> phi_lab;   ///< integral of omega (spin excluded), world frame, since the start
  std::vector<Eigen::Vector3d> phi_body;  ///< the same, components along the body's own axes
  std::vector<Eigen::Vector3d> velocity;
  std::vector<Eigen::Vector3d> angular_velocity;  ///< spin excluded, world frame
};

}  // namespace ed
