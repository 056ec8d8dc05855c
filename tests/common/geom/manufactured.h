#pragma once

/// Pairs of bodies whose distance is known by construction.

#include "common/geom/random.h"

#include <geom/geom.h>

#include <Eigen/Core>

#include <algorithm>
#include <limits>

namespace geom_test {

struct ManufacturedPair {
  geom::Pose X_WA;
  geom::Pose X_WB;
  Eigen::Vector3d normal;  ///< unit normal, A to B
  double distance;
  double size;  ///< |p_AB| + both bounding radii: the length that errors are relative to
};

/// Returns the size of the pair's coordinates: how far its points are from the origin.
inline double extent_of(const ManufacturedPair& pair) {
  return pair.X_WA.position().norm() + 2 * pair.size;
}

/// Places B so that the support points of `normal` are the witness points: sA + distance * normal = p_AB + sB(-normal).
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

/// Returns g(n) = n.p_AB - hA(n) - hB(-n), from the public support functions: a lower bound of the distance for any
/// unit n.
template <geom::SupportShape ShapeA, geom::SupportShape ShapeB>
double lower_bound(const ShapeA& a, const geom::Pose& X_WA, const ShapeB& b, const geom::Pose& X_WB,
                   const Eigen::Vector3d& n) {
  return n.dot(X_WB.position() - X_WA.position()) - a.support(X_WA.rotation().transpose() * n).height -
         b.support(X_WB.rotation().transpose() * -n).height;
}

/// Returns the tolerance of the contract of distance.h: |error of d| <= 1e-13 * size.
inline double distance_tolerance(double size) {
  return 1e-13 * size;
}

/// Returns a bound of the angle between the computed and the true normal, in radian.
///
/// The last Newton step is at most 1e-6 long, and its quadratic remainder 1e-12 times the relative change of the
/// curvature for a radian, at most about the aspect ratio; ten times that is allowed. The remaining error of steps of
/// third order, kChebyshevTolerance2 and kChebyshevSmallChange, is no larger. The second part is rounding: some
/// epsilons of size in the tangential mismatch of the support points, over the smallest eigenvalue of M + g I.
inline double normal_tolerance(const geom::Ellipsoid& a, const geom::Ellipsoid& b, double distance, double size) {
  const double aspect_ratio =
      std::max(a.bounding_radius() / a.inscribed_radius(), b.bounding_radius() / b.inscribed_radius());
  const double curvature = a.min_curvature_radius() + b.min_curvature_radius() + std::min(distance, 0.0);
  return 1e-11 * aspect_ratio + 32 * std::numeric_limits<double>::epsilon() * size / curvature;
}

}  // namespace geom_test
