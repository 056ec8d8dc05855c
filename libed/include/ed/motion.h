#pragma once

#include <ed/export.h>

#include <geom/pose.h>

#include <Eigen/Core>

namespace ed {

/// A rigid body that moves freely: its state at `time`. World frame unless a name says otherwise.
struct Motion {
  geom::Pose pose;                                             ///< body to world at `time`
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< of the centre of mass
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< omega, world frame
  Eigen::Vector3d inertia = Eigen::Vector3d::Ones();           ///< principal moments about body x, y, z; > 0
  double time = 0;
};

/// The same motion, its state taken at time t (before or after motion.time): exact, by the closed form, so that the
/// error is rounding, about 1e-16 |omega| |t - motion.time| radian, whatever the time between.
///
/// Spherical and symmetric tops (two moments equal, about any body axis): the body turns about its constant angular
/// momentum L at rate |L| / I_perp while it spins about its own axis. Throws std::invalid_argument for three different
/// moments (not available yet), and for values that are not finite or moments that no body can have.
ED_EXPORT Motion propagate(const Motion& motion, double t);

}  // namespace ed
