#pragma once

/// Contacts of two spheres, in closed form.

#include "contact/certified.h"

#include <ed/tolerances.h>

#include <Eigen/Core>

#include <cmath>

namespace ed::internal {

/// Finds the first contact in [now, end] of spheres whose centres are r apart now and move at v relative to each other,
/// `reach` the sum of their radii: the first root of |r + v tau|^2 = reach^2, in the form without cancellation. Spheres
/// that overlap by less than kOverlap * reach touch. `n` becomes the normal, if they touch or overlap.
inline Finding sphere_contact(const Eigen::Vector3d& r, const Eigen::Vector3d& v, double reach, double now, double end,
                              Eigen::Vector3d& n, FinderCounters& count) {
  ++count.predictions;
  ++count.evaluations;
  const double distance2 = r.squaredNorm();
  const double approach = r.dot(v);
  const auto set_normal = [&] {
    n = distance2 > 0 ? Eigen::Vector3d(r / std::sqrt(distance2)) : Eigen::Vector3d::UnitX();
  };
  if (distance2 < (1 - kOverlap) * (1 - kOverlap) * (reach * reach)) {
    set_normal();
    return {Outcome::overlapping, now, approach < 0};
  }
  if (!(approach < 0)) return {Outcome::clear, end};
  const double excess = distance2 - reach * reach;
  if (!(excess > 0)) {
    set_normal();
    return {Outcome::contact, now};
  }
  const double discriminant = approach * approach - v.squaredNorm() * excess;
  if (discriminant < 0) return {Outcome::clear, end};
  const double tau = excess / (std::sqrt(discriminant) - approach);
  if (!(now + tau <= end)) return {Outcome::clear, end};
  n = (r + tau * v).normalized();
  return {Outcome::contact, now + tau};
}

}  // namespace ed::internal
