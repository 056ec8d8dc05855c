#pragma once

#include <geom/ellipsoid.h>
#include <geom/export.h>
#include <geom/kernel/dual_newton.h>
#include <geom/pose.h>
#include <geom/shape.h>
#include <geom/superellipsoid.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <limits>

namespace geom {

/// Whether a query has an answer, and which.
enum class DistanceStatus {
  /// The bodies are apart (or touch). Certain where `distance` > 0: it is a lower bound.
  separated,
  /// They overlap. Certain where `distance + error_bound` < 0; for ellipsoids, to rounding, always. Flat and long
  /// superellipsoids and users' shapes that touch within the error bound may be either.
  overlapping,
  not_converged,  ///< no answer: neither the iteration nor the search over all normals ended with one
  singular,       ///< no answer: a linear system of the method was singular
};

/// The enumerator's name.
GEOM_EXPORT const char* to_string(DistanceStatus status);

/// What is asked of bodies that overlap.
enum class Penetration {
  global,  ///< the shortest of all translations that part them
  /// The nearest stationary one (the paper's beta < 0), at any depth: cheap. That the bodies overlap is certain (by a
  /// point that both hold), that no translation is shorter is not. Where no such point shows, in one of 5,000 deep
  /// overlaps (tests/property/geom_penetration_test.cpp), as `global`.
  local,
};

/// The enumerator's name.
GEOM_EXPORT const char* to_string(Penetration penetration);

/// Where a distance query starts, and how far it goes.
struct DistanceOptions {
  /// Warm start: a guess of the normal from A to B, for instance the last answer's. Any length from 1e-145 to 1e150;
  /// else, also if it is not finite: cold start.
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  /// Evaluations of the pair from each start, >= 1; superellipsoids: in each attempt, of short steps twice as many. The
  /// fallback's are not counted.
  int max_iterations = kMaxIterations;
  Penetration penetration = Penetration::global;
};

/// The answer of a distance query; every number is NaN when `status` declines it. World frame.
///
/// `point_b - point_a = distance * normal` to rounding. Either point is off its surface by about `error_bound` and
/// residual^2 / (2 * radius of curvature) at most; at a tip, and at an edge in deep overlaps of superellipsoids, by the
/// residual.
struct [[nodiscard]] DistanceResult {
  double distance = std::numeric_limits<double>::quiet_NaN();  ///< < 0: minus the penetration depth
  Eigen::Vector3d point_a = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Vector3d point_b = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Vector3d normal = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());  ///< unit, A to B
  DistanceStatus status = DistanceStatus::not_converged;
  int iterations = 0;  ///< evaluations of the pair, one a step however often it is shortened; a restart's included
  /// Length: how far the points found, those on the surfaces, are from being `distance * normal` apart.
  double residual = std::numeric_limits<double>::quiet_NaN();
  /// Certified: distance <= true distance <= distance + error_bound, rounding (1e-15 of the size of the pair) apart.
  /// Infinite where nothing is certified: the local penetration of deep overlaps.
  double error_bound = std::numeric_limits<double>::quiet_NaN();
};

/// Signed distance of two smooth convex bodies A at X_WA and B at X_WB,
///
///     d = max over unit n of g(n),   g(n) = n.(p_WB - p_WA) - hA(n) - hB(-n),
///
/// which is the distance of the closest points when the bodies are apart, and minus the length of the shortest
/// translation that parts them when they overlap. Dual Newton on the unit sphere (see kernel/dual_newton.h), for two
/// ellipsoids with steps of third order.
///
/// What is certified. g(n) is a lower bound of d for every n. Apart: g is concave where it is positive, so that a
/// stationary point with g > 0 is the global maximum. Overlapping: let rho be the sum of both bodies' smallest radii of
/// curvature (`min_curvature_radius`). A ball of radius rho rolls freely inside the Minkowski difference of the bodies
/// (Blaschke), so that a stationary point of depth -g <= rho is the global maximum too: the ball of radius -g around
/// the origin lies inside the ball of radius rho that touches the boundary at the same point. Deeper overlaps can have
/// several local maxima; branch and bound over all normals (kernel/sphere_search.h) finds the largest, at any depth,
/// concentric bodies included: no translation is shorter than the one returned by more than `error_bound`, mostly 1e-9
/// of the size, 1e-3 at most, or the pair is declined. (The normal returned is a local maximum to second order, no
/// saddle, where g has second derivatives; at edges and vertices it is the best one found. The bound says how much
/// better another one could be.) That takes 0.05 to 0.2 milliseconds for ellipsoids, and for superellipsoids 0.03 to
/// 0.12 at a depth of 1e-6 of the size and 0.2 to 0.3 at 0.1 (docs/accuracy.md, bench_superellipsoid), 100 at its
/// limit of kMostDepthSamples, as where a body sits in the centre of a round one; Penetration::local mostly avoids it.
///
/// Long bodies that lie in each other nearly parallel are the exception: all normals across them are nearly as good,
/// and the bounds are relative to the length, not to the thickness. Parallel needles take 0.4 milliseconds
/// at an aspect ratio of 10, 3 at 100 and 18 from 1000 on (medians; superellipsoids 0.4 to 0.8, up to 44), where the
/// search can end at kMostDepthSamples and `error_bound` can be as large as the depth. The depth found is that
/// of a brute-force search all the same (docs/accuracy.md, "Deep in each other").
///
/// Accuracy of ellipsoids: |error of d| <= 1e-13 times the size of the pair (|p_AB| + both bounding radii) apart and
/// down to a depth of rho, `error_bound` deeper; normals 1e-7 worst, 1e-12 typically. Both are asserted by
/// tests/accuracy. Other shapes: the same where Newton's method converges; where support points jump (flat faces,
/// edges), the answer of the closest points of two polytopes that grow inside the bodies, certified to 1e-9 of the size
/// (kWidestGap), or declined. Never throws, never allocates.
template <SupportShape ShapeA, SupportShape ShapeB>
DistanceResult distance(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                        const DistanceOptions& options = {});

/// The same for two ellipsoids: basis-free kernel if both are bodies of revolution, and a fallback for bodies apart
/// (Perram-Wertheim: concave maximisation in one variable, then an ascent that stays on g > 0). Where that does not end
/// with an answer either, the search over all normals gives one.
GEOM_EXPORT DistanceResult distance(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                                    const DistanceOptions& options = {});

/// The same where a body is a superellipsoid: Newton's method of contact elements, surface points with their normals;
/// where a body has no exponent of about 1 or less, or is an ellipsoid, that on the sphere goes first
/// (kernel/norm_body_pair.h).
///
/// Answers are certified by two bounds, g(n) from below and the distance of two points from above, that differ by less
/// than kBoundGap (1e-12) of the sum of both bounding radii. `error_bound` tells. Overlaps are searched as above. Where
/// the bodies are apart the normal is within sqrt(2 (error_bound + rounding, 1e-15 of the size) / distance) of the true
/// one (radian): g(n) <= distance times the cosine of that angle.
///
/// Apart, aspect ratios to 10 are within 1e-12 of the size of the pair; overlaps are within `error_bound`, 1e-9 of it,
/// and 1e-7 where faces meet (docs/accuracy.md).
/// Of flatter and longer bodies, to kMaxAspectRatio (1e4), some take the slow last resort, up to a tenth of a second:
/// apart, or slightly overlapping, their distance is certified to kWidestGap (1e-9), or declined, and whether they
/// overlap is certain only where |distance| is larger than `error_bound` (docs/accuracy.md counts such pairs).
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
