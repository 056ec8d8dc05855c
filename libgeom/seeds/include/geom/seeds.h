#pragma once

/// @file
/// Closest points from other libraries, as seeds of newton_distance: FCL and libccd. Part of hardbody::geom_seeds.
///
/// World frame, in and out. Nothing here throws on numerical grounds: a seed that has no points says so by its status,
/// and check_seed accepts every `usable` one.

#include <geom/any_shape.h>
#include <geom/ellipsoid.h>
#include <geom/export.h>
#include <geom/kernel/support_body.h>
#include <geom/newton.h>
#include <geom/pose.h>
#include <geom/shape.h>

namespace geom {

namespace kernel {
/// `ours`: what `distance` says of the pair. Not checked yet.
GEOM_EXPORT WitnessPair fcl_seed(const SupportBody& a, const SupportBody& b, const DistanceResult& ours);
}  // namespace kernel

/// The nearest points that FCL finds for two bodies that are apart. An ellipsoid is FCL's own, any other shape an
/// fcl::Convex: a polytope inscribed in it, of 500 support points.
///
/// Ellipsoids: about 3e-6 times the larger inscribed radius from the true distance at the median, 1e-3 at the worst
/// seen; the points themselves by more, the flatter the bodies. Superellipsoids: 7e-4 of the size of the pair at the
/// median, 9e-3 at the worst seen, their points 4e-3 and 3e-2. Takes a few microseconds for ellipsoids and 0.1 to 0.2
/// milliseconds for polytopes, most of it to make them. Newton's method converges from these points for all
/// pairs of ellipsoids; of superellipsoids for 99.98 % with eight equations and 99.7 % with five
/// (tests/oracle/superellipsoid_seeds_test.cpp prints it by exponent).
///
/// FCL is called only where it has an answer, and never where Debian's build of it, with assertions on, would end the
/// process:
/// - `distance` comes first: FCL is not asked of pairs that overlap (`overlapping` where `distance` says so or the
///   inscribed spheres meet, else `declined`), nor of those that touch, their gap below 1e-12 of their size
///   (`declined`): an assertion of its GJK fails on some of them;
/// - turned by an arbitrary rotation: the same assertion is a matter of chance then, and of chances of 1e-16, also for
///   bodies that are aligned with the axes;
/// - only with GST_LIBCCD, GST_INDEP ends the process on overlaps;
/// - only for the unsigned distance: with signed ones a pair that FCL takes for overlapping goes to its EPA, where the
///   assertions are;
/// - at its default tolerance of 1e-6, an absolute length, for which lengths are divided by the smaller inscribed
///   radius.
/// Where FCL throws, takes the pair for overlapping all the same, or returns a point deep inside a body (one in 1e5 or
/// so), the seed is `declined`. Allocates.
template <SupportShape ShapeA, SupportShape ShapeB>
WitnessPair fcl_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB) {
  const DistanceResult ours = distance(a, X_WA, b, X_WB);
  const WitnessPair seed = kernel::fcl_seed(kernel::SupportBody(a, X_WA), kernel::SupportBody(b, X_WB), ours);
  return kernel::checked(a, X_WA, b, X_WB, seed);
}

/// The same, compiled into the library.
/// @{
GEOM_EXPORT WitnessPair fcl_seed(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB);
GEOM_EXPORT WitnessPair fcl_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);
/// @}

namespace kernel {
GEOM_EXPORT WitnessPair ccd_seed(const SupportBody& a, const SupportBody& b);
}

/// Points from libccd, whose Minkowski portal refinement (MPR) tells the depth of overlaps but no distances: both
/// bodies are inflated by the same ball until MPR reports contact, and its contact point, moved back along its normal
/// by what was added, is taken. Overlapping bodies: the support points along MPR's normal, a guess that is good for
/// shallow overlaps only.
///
/// The points are those of the bodies to about 1e-3 of the size of the pair; superellipsoids: 4e-4 at the median, 4e-2
/// at the worst seen. Takes 16 microseconds for ellipsoids, 25 for superellipsoids. Newton's method converges from
/// these points for all pairs of ellipsoids with eight equations and 99.97 % with five, of superellipsoids for 99.98 %
/// and 99.8 %. Declined if the centres coincide or MPR does not settle.
template <SupportShape ShapeA, SupportShape ShapeB>
WitnessPair ccd_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB) {
  const WitnessPair seed = kernel::ccd_seed(kernel::SupportBody(a, X_WA), kernel::SupportBody(b, X_WB));
  return kernel::checked(a, X_WA, b, X_WB, seed);
}

/// The same for shapes chosen at run time.
GEOM_EXPORT WitnessPair ccd_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);

}  // namespace geom
