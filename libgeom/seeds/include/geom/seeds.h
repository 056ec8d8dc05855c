#pragma once

/// @file
/// Closest points from other libraries, as seeds of newton_distance: FCL and libccd. Part of hardbody::geom_seeds.
///
/// Input and output are in the world frame. Nothing here throws on numerical grounds: a seed without points reports
/// that in its status, and check_seed accepts every `usable` one.

#include <geom/any_shape.h>
#include <geom/ellipsoid.h>
#include <geom/export.h>
#include <geom/kernel/support_body.h>
#include <geom/newton.h>
#include <geom/pose.h>
#include <geom/shape.h>

namespace geom {

namespace kernel {
/// Computes the seed of FCL, not checked yet. `ours`: the answer of `distance` for the pair.
GEOM_EXPORT WitnessPair fcl_seed(const SupportBody& a, const SupportBody& b, const DistanceResult& ours);
}  // namespace kernel

/// Returns the nearest points that FCL finds for two bodies that are apart. An ellipsoid is FCL's own, any other shape
/// an fcl::Convex: a polytope inscribed in it, of 500 support points.
///
/// Ellipsoids: about 3e-6 times the larger inscribed radius from the true distance at the median, 1e-3 at the worst
/// seen; the error of the points themselves is larger, the more so the flatter the bodies. Superellipsoids: 7e-4 of the
/// size of the pair at the median, 9e-3 at the worst seen, their points 4e-3 and 3e-2. Takes a few microseconds for
/// ellipsoids and 0.1 to 0.2 milliseconds for polytopes, most of it to make them. Newton's method converges from these
/// points for all pairs of ellipsoids; for superellipsoids 99.98 % with eight equations and 99.7 % with five
/// (tests/oracle/superellipsoid_seeds_test.cpp prints it by exponent).
///
/// FCL is called only where it has an answer, and never where Debian's build of it, with assertions on, would abort the
/// process:
/// - `distance` comes first. FCL is not called for pairs that overlap (`overlapping` if `distance` finds an overlap or
///   the inscribed spheres overlap, else `declined`), nor for pairs that touch, their gap below 1e-12 of their size
///   (`declined`): an assertion of its GJK fails on some of them.
/// - The pair is turned by an arbitrary rotation: the same assertion then fails by chance only, with a probability of
///   1e-16, also for bodies that are aligned with the axes.
/// - Only GST_LIBCCD is used: GST_INDEP aborts the process on overlaps.
/// - Only the unsigned distance is used: with signed ones a pair that FCL considers overlapping goes to its EPA, which
///   contains the assertions.
/// - Lengths are divided by the smaller inscribed radius, because FCL's default tolerance of 1e-6 is an absolute
///   length.
///
/// If FCL throws, considers the pair overlapping all the same, or returns a point deep inside a body (about one in
/// 1e5), the seed is `declined`. Allocates.
template <SupportShape ShapeA, SupportShape ShapeB>
WitnessPair fcl_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB) {
  const DistanceResult ours = distance(a, X_WA, b, X_WB);
  const WitnessPair seed = kernel::fcl_seed(kernel::SupportBody(a, X_WA), kernel::SupportBody(b, X_WB), ours);
  return kernel::checked(a, X_WA, b, X_WB, seed);
}

/// Overload compiled into the library.
/// @{
GEOM_EXPORT WitnessPair fcl_seed(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB);
GEOM_EXPORT WitnessPair fcl_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);
/// @}

namespace kernel {
GEOM_EXPORT WitnessPair ccd_seed(const SupportBody& a, const SupportBody& b);
}

/// Returns points from libccd, whose Minkowski portal refinement (MPR) gives the depth of overlaps but no distances.
/// Both bodies are inflated by the same ball until MPR reports contact, and its contact point is moved back along its
/// normal by the radius added. Overlapping bodies: the support points along MPR's normal, a guess that is good for
/// shallow overlaps only.
///
/// The points are those of the bodies to about 1e-3 of the size of the pair; superellipsoids: 4e-4 at the median, 4e-2
/// at the worst seen. Takes 16 microseconds for ellipsoids, 25 for superellipsoids. Newton's method converges from
/// these points for all pairs of ellipsoids with eight equations and 99.97 % with five, for superellipsoids 99.98 % and
/// 99.8 %. Declines if the centres coincide or MPR does not converge.
template <SupportShape ShapeA, SupportShape ShapeB>
WitnessPair ccd_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB) {
  const WitnessPair seed = kernel::ccd_seed(kernel::SupportBody(a, X_WA), kernel::SupportBody(b, X_WB));
  return kernel::checked(a, X_WA, b, X_WB, seed);
}

/// Overload for shapes chosen at run time.
GEOM_EXPORT WitnessPair ccd_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);

}  // namespace geom
