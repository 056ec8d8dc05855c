#pragma once

#include <ed/export.h>

#include <geom/pose.h>

#include <Eigen/Core>

namespace ed {

/// Free motion of a rigid body, given by its state at `time`. World frame unless a name says otherwise. Functions
/// refuse velocities and angular velocities longer than kMaxSpeed, and others than 0 that are shorter than kMinSpeed
/// (ed/tolerances.h): their squares would overflow or underflow.
struct Motion {
  geom::Pose pose;                                             ///< body to world at `time`
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< velocity of the centre of mass
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< omega, world frame
  Eigen::Vector3d inertia = Eigen::Vector3d::Ones();           ///< principal moments about body x, y, z; > 0
  double time = 0;
};

/// Returns the same motion with its state at time t (before or after motion.time), by closed forms. The error is
/// rounding, below 2e-15 (1 + |omega| |t - motion.time|) radian, however long the interval.
///
/// The angular momentum L is constant. Three equal moments: the body rotates uniformly. Two equal moments, about any
/// body axis: it rotates about L at rate |L| / I_perp while it spins about its own axis. Three different moments:
/// elliptic functions of time (Landau and Lifshitz, Mechanics, sec. 37), also for moments that nearly agree and for any
/// omega. Close to rotation about the axis of the middle moment, which is unstable, and to the motions that lead there,
/// the motion itself magnifies small differences: the result is then as accurate as omega, which is known to rounding.
///
/// Throws std::invalid_argument for values that are not finite, speeds that Motion does not allow, moments that no body
/// can have, and a time at which the body is beyond geom::kMaxCoordinate.
ED_EXPORT Motion propagate(const Motion& motion, double t);

}  // namespace ed
