#pragma once

/// Pairs of bodies whose distance is known before it is computed.

#include "common/geom_random.h"

#include <geom/geom.h>

#include <Eigen/Core>

namespace geom_test {

struct ManufacturedPair {
  geom::Pose X_WA;
  geom::Pose X_WB;
  Eigen::Vector3d normal;  ///< unit, A to B
  double distance;
  double size;  ///< |p_AB| + both bounding radii: what errors are relative to
};

/// Puts B so that the support points of `normal` are the witness points: sA + distance * normal = p_AB + sB(-normal).
///
/// Exact up to the rounding of p_WB for distance >= 0 (both bodies lie on their sides of two parallel planes), and for
/// overlaps no deeper than the sum of both smallest radii of curvature (see distance.h).
template <geom::SupportShape ShapeA, geom::SupportShape ShapeB>
ManufacturedPair manufacture(const ShapeA& a, const ShapeB& b, double distance, Random& random) {
  const double radii = a.bounding_radius() + b.bounding_radius();
  const Eigen::Vector3d n = random.direction();
  const geom::Pose X_WA = random.pose(radii);
  const geom::Pose X_turned = random.pose(0.0);
  const Eigen::Vector3d s_a = X_WA.rotation() * a.support(X_WA.rotation().transpose() * n).point;
  const Eigen::Vector3d s_b = X_turned.rotation() * b.support(X_turned.rotation().transpose() * -n).point;
  const Eigen::Vector3d p_AB = s_a - s_b + distance * n;
  const geom::Pose X_WB(X_turned.rotation(), X_WA.position() + p_AB);
  return {X_WA, X_WB, n, distance, p_AB.norm() + radii};
}

}  // namespace geom_test
