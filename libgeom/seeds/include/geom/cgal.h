#pragma once

/// @file
/// Closest points from CGAL, as seeds of newton_distance. Part of hardbody::geom_cgal.
///
/// CGAL's Polytope_distance_d is under the GPL, version 3 or later, and so is a program that links hardbody::geom_cgal.

#include <geom/any_shape.h>
#include <geom/export.h>
#include <geom/kernel/support_body.h>
#include <geom/newton.h>
#include <geom/pose.h>
#include <geom/shape.h>

namespace geom {

namespace kernel {
GEOM_EXPORT WitnessPair cgal_seed(const SupportBody& a, const SupportBody& b);
}

/// Returns the closest points of two polytopes inscribed in the bodies, from CGAL's Polytope_distance_d in exact
/// arithmetic. World frame.
///
/// A polytope has 200 vertices, support points of directions that are evenly spread after scaling the body's widths
/// along its axes to one; between the vertices it lies inside the body by up to about 2 % of the widths. The points are
/// those of the bodies to about 1 % of the size of the pair (superellipsoids: 3 % at the worst seen). Newton's method
/// converges from them for all pairs of ellipsoids with eight equations and 99.85 % with five, for 99.96 % and 99.6 %
/// of the pairs of superellipsoids. `overlapping` if the polytopes overlap, which proves that the bodies do. Allocates;
/// takes about a millisecond.
template <SupportShape ShapeA, SupportShape ShapeB>
WitnessPair cgal_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB) {
  const WitnessPair seed = kernel::cgal_seed(kernel::SupportBody(a, X_WA), kernel::SupportBody(b, X_WB));
  return kernel::checked(a, X_WA, b, X_WB, seed);
}

/// Overload for shapes chosen at run time.
GEOM_EXPORT WitnessPair cgal_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);

}  // namespace geom
