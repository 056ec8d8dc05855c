#pragma once

/// @file
/// The paper's distance equations, solved by Newton's method from a guess of the closest points.
///
/// `distance` (distance.h) needs no guess, is faster and answers every separated pair. `newton_distance` is an
/// independent method, for bodies given by an equation f(x) = 0 alone, and for checking one method against the other.

#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/export.h>
#include <geom/pose.h>
#include <geom/shape.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <limits>

namespace geom {

/// Outcome of a search for starting points.
enum class SeedStatus {
  usable,       ///< the points are finite, on or near their surfaces
  overlapping,  ///< no points: the bodies overlap, and this seed has none for overlaps
  declined,     ///< no points for another reason
};

/// Returns the enumerator's name.
GEOM_EXPORT const char* to_string(SeedStatus status);

/// Guess of the closest points of two bodies (of the deepest ones, if they overlap). World frame; the points are NaN
/// unless `status` is `usable`.
struct [[nodiscard]] WitnessPair {
  Eigen::Vector3d point_a = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Vector3d point_b = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  SeedStatus status = SeedStatus::declined;
};

/// Variant of the paper's equations that is solved.
enum class NewtonSystem {
  eight,  ///< eqs. (dist8) in the unknowns xA, xB, alpha, beta
  five,   ///< xB eliminated by eq. (dist8d): unknowns xA, alpha, beta
};

/// Returns the enumerator's name.
GEOM_EXPORT const char* to_string(NewtonSystem system);

/// Limits of `newton_distance`.
struct NewtonOptions {
  /// Maximum number of evaluations of the equations in each of two attempts, >= 1.
  int max_iterations = kMaxNewtonIterations;
};

/// Returns the signed distance of two smooth convex bodies A = {f <= 0} at X_WA and B = {g <= 0} at X_WB, from the
/// paper's equations for points xA, xB on their surfaces:
///
///     f_x(xA) = -alpha^2 g_x(xB)   (dist8a)      f(xA) = 0   (dist8b)      g(xB) = 0   (dist8c)
///     xA + beta f_x(xA) = xB       (dist8d)
///
/// The method is Newton's, y <- y - t J^-1 F(y) with the analytic Jacobian (the paper's eq. (NRiter) lost the minus
/// sign) and step lengths t <= 1. If it does not converge, a second attempt requires |F| to fall (see
/// kernel/newton_impl.h). The distance is beta |f_x|. For overlapping bodies beta < 0, and the distance is the paper's
/// "negative distance", minus the length of the shortest translation that separates them.
///
/// Certificates. The equations have several solutions. One with beta > 0 is the answer: the outward normals are
/// antiparallel and along xB - xA, so that the tangent planes at xA and xB have A on one side and B on the other, and
/// no two points can be closer. One with beta < 0 is the answer down to the depth `min_curvature_radius` of A plus that
/// of B (see distance.h for why; shapes without that function count as 0); deeper ones are declined (`not_converged`).
/// Both conditions are checked on the solution found, not assumed of the seed: no seed leads to a wrong answer, a bad
/// one only to a declined one.
///
/// The normals of bodies with flat faces or sharp edges do not bound how far a point is from the solution. Such bodies
/// need a support function (superellipsoids have one): g(n) of distance.h then bounds the distance from below.
///
/// Accuracy: |error of d| <= 1e-13 times the size of the pair (|p_AB| + |xA - p_WA| + |xB - p_WB|). Members of the
/// result: `error_bound` is that of the solution found, the remaining error is rounding; `residual` is the part of xB -
/// xA across the normal; `iterations` counts evaluations of the equations; status `singular` means that the Jacobian
/// was singular or a gradient vanished.
///
/// A seed whose status is not `usable` gives `not_converged` without any iteration. Throws std::invalid_argument if
/// check_seed does, else never; does not allocate.
template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
DistanceResult newton_distance(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                               NewtonSystem system, const WitnessPair& seed, const NewtonOptions& options = {});

/// Overload compiled into the library.
GEOM_EXPORT DistanceResult newton_distance(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                                           NewtonSystem system, const WitnessPair& seed,
                                           const NewtonOptions& options = {});

/// Throws std::invalid_argument if a `usable` seed has a point that is not finite, or that lies inside its body by more
/// than kMaxSeedDepth (relative to its distance from the body's centre; to first order, -f / |f_x|).
template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
void check_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const WitnessPair& seed);

/// Returns the seed, or a declined one if check_seed would refuse it. Never throws.
template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
WitnessPair checked_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const WitnessPair& seed);

/// Returns the points where the line of centres leaves A and enters B: a crude guess. Declines if the centres coincide,
/// or a centre is not inside its body. Relative accuracy of the points 1e-9. Takes 0.3 microseconds for ellipsoids, 3
/// for superellipsoids. From these points Newton's method converges for 99.8 % of the pairs of ellipsoids with eight
/// equations and 96.5 % with five (82 % at X0 = 0.1), and for 99.2 % and 98.3 % of the pairs of superellipsoids
/// (docs/accuracy.md compares the seeds).
template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
WitnessPair centre_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB);

/// Returns the support points of A along n and of B along -n; n in the world frame, of any length. Declines if n is
/// zero or not finite. Takes 0.05 microseconds for ellipsoids, 0.3 for superellipsoids. The guess is as good as the
/// normal is.
template <SupportShape ShapeA, SupportShape ShapeB>
WitnessPair normal_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const Eigen::Vector3d& n);

/// Returns the witness points of `distance`; declines if `distance` does. Takes as long as `distance`, 0.2 to 0.3
/// microseconds for ellipsoids, 1 to 3 for superellipsoids. From these points Newton's method converges for all pairs
/// of ellipsoids, and for 99.99 % or more of the pairs of superellipsoids with eight equations, 99.97 % with five.
template <SupportShape ShapeA, SupportShape ShapeB>
WitnessPair dual_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB);

namespace kernel {

/// Computes newton_distance for the event loop: never throws. A bad seed leads to a declined answer.
template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
DistanceResult newton_distance_unchecked(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                                         NewtonSystem system, const WitnessPair& seed,
                                         const NewtonOptions& options = {});
GEOM_EXPORT DistanceResult newton_distance_unchecked(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b,
                                                     const Pose& X_WB, NewtonSystem system, const WitnessPair& seed,
                                                     const NewtonOptions& options = {});

}  // namespace kernel
}  // namespace geom

#include <geom/kernel/newton_impl.h>

namespace geom {
namespace kernel {

/// Returns whether check_seed accepts the point of a usable seed.
template <ImplicitSurface Shape>
bool is_seed_point(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& p_W) {
  if (!p_W.allFinite()) return false;
  const Eigen::Vector3d x = X_WB.to_body(p_W);
  return shape.value(x) >= least_seed_value(shape, x);
}

}  // namespace kernel

template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
WitnessPair checked_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                         const WitnessPair& seed) {
  if (seed.status != SeedStatus::usable) return seed;
  const bool good = kernel::is_seed_point(a, X_WA, seed.point_a) && kernel::is_seed_point(b, X_WB, seed.point_b);
  return good ? seed : WitnessPair{};
}

}  // namespace geom
