#pragma once

#include <geom/ellipsoid.h>
#include <geom/export.h>
#include <geom/kernel/core.h>
#include <geom/kernel/dual_newton.h>
#include <geom/pose.h>
#include <geom/round_shapes.h>
#include <geom/shape.h>
#include <geom/superellipsoid.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <limits>

namespace geom {

/// Outcome of a distance query.
enum class DistanceStatus {
  /// The bodies are apart (or touch). Certain if `distance` > 0, which is a lower bound.
  separated,
  /// The bodies overlap. Certain if `distance + error_bound` < 0; for ellipsoids always certain, up to rounding. Flat
  /// and long superellipsoids and users' shapes that touch within the error bound may be either.
  overlapping,
  not_converged,  ///< no answer: neither the iteration nor the search over all normals ended with one
  singular,       ///< no answer: a linear system of the method was singular
};

/// Returns the enumerator's name.
GEOM_EXPORT const char* to_string(DistanceStatus status);

/// Translation that is searched for when the bodies overlap.
enum class Penetration {
  global,  ///< the shortest of all translations that separate them
  /// The nearest stationary translation (the paper's beta < 0), at any depth: cheap. The overlap itself is certain (a
  /// point inside both bodies has been found); that no translation is shorter is not. If no common point is found, in
  /// one of 5,000 deep overlaps (tests/property/geom_penetration_test.cpp), the query continues as with `global`.
  local,
};

/// Returns the enumerator's name.
GEOM_EXPORT const char* to_string(Penetration penetration);

/// Start and limits of a distance query.
struct DistanceOptions {
  /// Warm start: a guess of the normal from A to B, for instance the last answer's. Its length may be anything from
  /// 1e-145 to 1e150; a vector of another length, or one that is not finite, gives a cold start.
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  /// Maximum number of evaluations of the pair from each start, >= 1. For superellipsoids the limit holds for each
  /// attempt, and attempts with short steps may take twice as many. Evaluations of the fallback are not counted.
  int max_iterations = kMaxIterations;
  Penetration penetration = Penetration::global;
};

/// Answer of a distance query, in the world frame. Every number is NaN if `status` declines.
///
/// `point_b - point_a = distance * normal` to rounding. Each point is off its surface by at most about `error_bound`
/// plus residual^2 / (2 * radius of curvature); at a tip, and at an edge in deep overlaps of superellipsoids, by the
/// residual.
struct [[nodiscard]] DistanceResult {
  double distance = std::numeric_limits<double>::quiet_NaN();  ///< signed distance; < 0: minus the penetration depth
  Eigen::Vector3d point_a = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Vector3d point_b = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Unit vector from A to B.
  Eigen::Vector3d normal = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  DistanceStatus status = DistanceStatus::not_converged;
  /// Number of evaluations of the pair, one a step however often it is shortened; includes restarts.
  int iterations = 0;
  /// Deviation (length) of the points found, those on the surfaces, from being `distance * normal` apart.
  double residual = std::numeric_limits<double>::quiet_NaN();
  /// Certified: distance <= true distance <= distance + error_bound, apart from rounding (1e-15 of the size of the
  /// pair). Infinite where nothing is certified: the local penetration of deep overlaps.
  double error_bound = std::numeric_limits<double>::quiet_NaN();
};

/// Returns the signed distance of two smooth convex bodies A at X_WA and B at X_WB,
///
///     d = max over unit n of g(n),   g(n) = n.(p_WB - p_WA) - hA(n) - hB(-n),
///
/// which is the distance of the closest points when the bodies are apart, and minus the length of the shortest
/// translation that separates them when they overlap. The method is dual Newton on the unit sphere (see
/// kernel/dual_newton.h), for two ellipsoids with steps of third order.
///
/// Certificates. g(n) is a lower bound of d for every n. Bodies apart: g is concave where it is positive, so that a
/// stationary point with g > 0 is the global maximum. Overlapping bodies: let rho be the sum of both bodies' smallest
/// radii of curvature (`min_curvature_radius`). A ball of radius rho rolls freely inside the Minkowski difference of
/// the bodies (Blaschke), so that a stationary point of depth -g <= rho is the global maximum too: the ball of radius
/// -g around the origin lies inside the ball of radius rho that touches the boundary at the same point.
///
/// Deeper overlaps can have several local maxima. Branch and bound over all normals (kernel/sphere_search.h) finds the
/// largest, at any depth, concentric bodies included: no translation is shorter than the one returned by more than
/// `error_bound`, mostly 1e-9 of the size, 1e-3 at most, or the pair is declined. (The normal returned is a local
/// maximum to second order, no saddle, where g has second derivatives; at edges and vertices it is the best one found,
/// and the bound limits how much better another one could be. Where support points jump, as on faces, the closest
/// features of the bodies moved apart have its points, to some 1e-7 of the size, which `residual` tells.) The search
/// takes 0.05 to 0.2 milliseconds for ellipsoids, 0.2 to 0.3 for superellipsoids at a depth of 0.1 of the size, 0.03 to
/// 0.12 at 1e-6 for those with an exponent above 1, which have no curvature radius (docs/accuracy.md,
/// bench_superellipsoid), and 10 to 100 at its limit of kMostDepthSamples, for instance if a superellipsoid sits in the
/// centre of a round body. Penetration::local mostly avoids it. Bodies of revolution whose axes are parallel are
/// searched along a half-circle (kernel/meridian_search.h), in tens of microseconds. Of axes parallel to 1e-9 to 1e-3
/// only, the best normals nearly form a circle: the bound is then up to 1e-7 of the size for smooth bodies, 1e-5 for
/// cylinders and cones.
///
/// Long bodies that overlap nearly parallel to each other are the exception: all normals across them are nearly as
/// good, and the bounds are relative to the length, not to the thickness. Parallel needles take 0.4 milliseconds at an
/// aspect ratio of 10, 3 at 100 and 18 from 1000 on (medians; superellipsoids 0.4 to 0.8, up to 44); the search can
/// then end at kMostDepthSamples, and `error_bound` can be as large as the depth. The depth found still equals that of
/// a brute-force search (docs/accuracy.md, "Deep in each other").
///
/// Accuracy for ellipsoids: |error of d| <= 1e-13 times the size of the pair (|p_AB| + both bounding radii) when apart
/// and down to a depth of rho, `error_bound` deeper; normals 1e-7 worst, 1e-12 typically. Both are asserted by
/// tests/accuracy. Accuracy for other shapes: the same where Newton's method converges. Where support points jump (flat
/// faces, edges), the answer comes from the closest points of two polytopes that grow inside the bodies, from the
/// normal on that Newton's method has reached; it is certified to 1e-9 of the size (kWidestGap), or declined. Never
/// throws, never allocates.
///
/// Polytopes with balls swept over them (CoreShape: spheres, capsules, boxes, polyhedra, rounded ones) need no search:
/// the distance is that of the cores less both radii, at any depth, as support functions are additive. Points and
/// segments, and a box and a point, have closed forms. Other cores that are apart are left to the algorithm of Gilbert,
/// Johnson and Keerthi (IEEE J. Robotics Autom. 4 (1988) 193), which ends with the closest vertices, edges or faces.
/// Cores that overlap have the depth of the nearest face of their Minkowski difference: faces of either and pairs of
/// edges, all of which are tried. Answers are certified by two bounds as for superellipsoids: g(normal) from below, the
/// distance of two points of the cores from above. A pair where they differ by more than kBoundGap (1e-12) of the size
/// is declined; the tests assert 1e-13. Where faces, or edges, are parallel, one of many pairs of closest points is
/// returned. `max_iterations` and `penetration` do not count: the iteration is finite, and the depth is always the
/// smallest one.
///
/// Cylinders, cones and rounded ones are CoreShapes, too: hulls of two discs. A point has a closed form, as has a face
/// flat on the other body; other pairs that are apart take that algorithm with points that slide along the rims, by
/// Newton's method, and end with the same two bounds. Of cores that overlap by less than 1e-9 of the size,
/// `error_bound` is mostly less than the depth: then the overlap is certain, however shallow; else it is twice the
/// depth. Deeper ones are searched over all normals, as above: their depth is certified to `error_bound`, 1e-9 of the
/// size but for nearly parallel axes, and takes a tenth of a millisecond, 20 to 50 at the limit.
///
/// A rounded shape (rounded.h) has the distance of the shape inside, less the radius, with the certificate of that. A
/// sphere beside a smooth body is an ellipsoid with three equal semi-axes; a capsule has the distance of the ball on
/// its axis that is closest, found from the balls' normals, or where the body reaches the axis that of the general
/// method. A box or a polyhedron apart from a smooth body has the distance of its closest vertex, edge or face, with
/// the certificate of superellipsoids; overlaps, and other shapes beside smooth bodies, are left to the general method.
template <SupportShape ShapeA, SupportShape ShapeB>
DistanceResult distance(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                        const DistanceOptions& options = {});

/// Overload for two ellipsoids, with a basis-free kernel if both are bodies of revolution, and a fallback for bodies
/// apart (Perram-Wertheim: concave maximisation in one variable, then an ascent that stays on g > 0). If that does not
/// converge either, the search over all normals gives the answer.
GEOM_EXPORT DistanceResult distance(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                                    const DistanceOptions& options = {});

/// Overload for pairs with a superellipsoid. The method is Newton's on contact elements, surface points with their
/// normals. If a body has no exponent of about 1 or less, or is an ellipsoid, Newton's method on the sphere goes first
/// (kernel/norm_body_pair.h).
///
/// Answers are certified by two bounds, g(n) from below and the distance of two points from above, that differ by less
/// than kBoundGap (1e-12) of the sum of both bounding radii; `error_bound` is their difference. Overlaps down to the
/// sum of both `min_curvature_radius` are certified as closely, by the balls that roll inside the bodies, in 2 to 4
/// microseconds; deeper ones are searched as above. For bodies apart the normal is within sqrt(2 (error_bound +
/// rounding, 1e-15 of the size) / distance) of the true one (radian), because g(n) <= distance times the cosine of that
/// angle.
///
/// Accuracy for aspect ratios up to 10: within 1e-12 of the size of the pair for bodies apart and shallow overlaps;
/// within `error_bound` for deeper ones, which is 1e-9 of the size, and 1e-7 where faces meet (docs/accuracy.md). Some
/// flatter and longer bodies, up to kMaxAspectRatio (1e4), need the slow last resort, up to a tenth of a second. If
/// they are apart, or slightly overlapping, their distance is certified to kWidestGap (1e-9), or declined, and whether
/// they overlap is certain only if |distance| is larger than `error_bound` (docs/accuracy.md counts such pairs).
/// @{
GEOM_EXPORT DistanceResult distance(const Superellipsoid& a, const Pose& X_WA, const Superellipsoid& b,
                                    const Pose& X_WB, const DistanceOptions& options = {});
GEOM_EXPORT DistanceResult distance(const Superellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                                    const DistanceOptions& options = {});
GEOM_EXPORT DistanceResult distance(const Ellipsoid& a, const Pose& X_WA, const Superellipsoid& b, const Pose& X_WB,
                                    const DistanceOptions& options = {});
/// @}

}  // namespace geom

#include <geom/kernel/distance_impl.h>
