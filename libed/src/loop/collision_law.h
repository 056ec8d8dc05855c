#pragma once

#include <ed/impulse.h>

#include <Eigen/Core>

#include <concepts>

namespace ed::internal {

/// Law of collisions, a parameter of the event loop: how two bodies leave a contact.
///
/// Called with both bodies and the unit normal from A to B, it changes their velocities by an impulse J n on B and -J n
/// on A and returns J > 0. The contact points must part then, or the same contact would be found again. If they do not
/// approach before, it changes nothing and returns 0. States do not hold a law: whoever restores hands it in again.
template <class Law>
concept CollisionLaw = requires(Law law, ContactBody& a, ContactBody& b, const Eigen::Vector3d& normal) {
  { law(a, b, normal) } -> std::same_as<double>;
};

/// Elastic collision of smooth bodies.
struct SmoothElastic {
  double operator()(ContactBody& a, ContactBody& b, const Eigen::Vector3d& normal) const {
    return collide(a, b, normal);
  }
};

}  // namespace ed::internal
