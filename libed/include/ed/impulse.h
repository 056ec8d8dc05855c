#pragma once

#include <ed/export.h>

#include <Eigen/Core>

namespace ed {

/// State of one of two bodies in contact. World frame.
struct ContactBody {
  double inverse_mass = 1;
  /// Inverse inertia tensor about the centre, world frame.
  Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Identity();
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();  ///< vector from the centre to the contact point
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
};

/// Returns the velocity of B's contact point relative to A's along the normal (unit, from A to B); negative: the bodies
/// approach.
ED_EXPORT double normal_velocity(const ContactBody& a, const ContactBody& b, const Eigen::Vector3d& normal);

/// Applies an elastic, frictionless collision: reverses the normal velocity of the contact points and changes both
/// bodies' velocities by the impulse J n (on B; -J n on A),
///
///     J = -2 v_n / (1/mA + 1/mB + (rA x n).IA^-1 (rA x n) + (rB x n).IB^-1 (rB x n)).
///
/// Returns J >= 0, or 0 and changes nothing if the contact points do not approach. Energy, momentum and angular
/// momentum are conserved to rounding for every unit n, even one that is not the true normal.
ED_EXPORT double collide(ContactBody& a, ContactBody& b, const Eigen::Vector3d& normal);

}  // namespace ed
