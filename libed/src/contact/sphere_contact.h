#pragma once

/// Contacts of two spheres.

#include "contact/certified.h"
#include "contact/spheres.h"

#include <Eigen/Core>

#include <cmath>

namespace ed::internal {

/// Finds the first contact in [now, end] of spheres whose centres are r apart now and move at v relative to each other,
/// `reach` the sum of their radii. Spheres that overlap by less than kOverlap * reach touch. `n` becomes the normal if
/// they touch or overlap.
inline Finding sphere_contact(const Eigen::Vector3d& r, const Eigen::Vector3d& v, double reach, double now, double end,
                              Eigen::Vector3d& n, FinderCounters& count) {
  ++count.predictions;
  ++count.evaluations;
  ++count.kernel_calls;
  const SpheresOf<double> spheres(r, v, reach);
  if (spheres.clear(now, end)) return {Outcome::clear, end};
  const double tau = spheres.overlap() || spheres.touch() ? 0 : spheres.time();
  const Eigen::Vector3d between = r + tau * v;
  n = between.squaredNorm() > 0 ? Eigen::Vector3d(between.normalized()) : Eigen::Vector3d::UnitX();
  if (spheres.overlap()) return {Outcome::overlapping, now, spheres.approach < 0};
  return {Outcome::contact, now + tau};
}

}  // namespace ed::internal
