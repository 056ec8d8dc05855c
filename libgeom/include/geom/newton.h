#pragma once

/// @file
/// The paper's distance equations, solved by Newton's method from a guess of the closest points.
///
/// `distance` (distance.h) needs no guess, is faster and answers every separated pair. This is the other way, for
/// bodies given by an equation f(x) = 0 alone, and to check one against the other.

#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/export.h>
#include <geom/pose.h>
#include <geom/shape.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <limits>

namespace geom {

/// Whether a seed has points to start from.
enum class SeedStatus {
  usable,       ///< the points are finite, on or near their surfaces
  overlapping,  ///< no points: the bodies overlap, for which this seed has none to offer
  declined,     ///< no points for another reason
};

/// The enumerator's name.
GEOM_EXPORT const char* to_string(SeedStatus status);

/// A guess of the closest points of two bodies (of the deepest ones, if they overlap). World frame; the points are NaN
/// unless `status` is `usable`.
struct [[nodiscard]] WitnessPair {
  Eigen::Vector3d point_a = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Vector3d point_b = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  SeedStatus status = SeedStatus::declined;
};

/// Which of the paper's equations are solved.
enum class NewtonSystem {
  eight,  ///< eqs. (dist8) in the unknowns xA, xB, alpha, beta
  five,   ///< xB eliminated by eq. (dist8d): unknowns xA, alpha, beta
};

/// The enumerator's name.
GEOM_EXPORT const char* to_string(NewtonSystem system);

/// How far `newton_distance` goes.
struct NewtonOptions {
  int max_iterations = kMaxNewtonIterations;  ///< evaluations of the equations in each of two attempts, >= 1
};

/// Signed distance of two smooth convex bodies A = {f <= 0} at X_WA and B = {g <= 0} at X_WB, from the paper's
/// equations for points xA, xB on their surfaces:
///
///     f_x(xA) = -alpha^2 g_x(xB)   (dist8a)      f(xA) = 0   (dist8b)      g(xB) = 0   (dist8c)
///     xA + beta f_x(xA) = xB       (dist8d)
///
/// Newton's method, y <- y - t J^-1 F(y) with the analytic Jacobian (the paper's eq. (NRiter) lost the minus sign) and
/// step lengths t <= 1, and where that does not settle a second attempt, with |F| falling (see
/// kernel/newton_impl.h). The distance is beta |f_x|: where the bodies overlap beta < 0, and
/// it is the paper's "negative distance", minus the length of the shortest translation that parts them.
///
/// What is certified. The equations have several solutions; one with beta > 0 is the answer: the outward normals are
/// antiparallel and along xB - xA, so that the tangent planes at xA and xB have A on one side and B on the other, and
/// no two points can be closer. One with beta < 0 is the answer down to the depth `min_curvature_radius` of A plus that
/// of B (see distance.h for why; shapes without that function count as 0); deeper ones are declined (`not_converged`).
/// Both are checked on the solution found, not assumed of the seed: no seed leads to a wrong answer, a bad one only to
/// a declined one.
///
/// Bodies with flat faces or sharp edges, whose normals do not tell how far off a point is, need a support function for
/// that (superellipsoids have one): g(n) of distance.h bounds the distance from below.
///
/// Accuracy: |error of d| <= 1e-13 times the size of the pair (|p_AB| + |xA - p_WA| + |xB - p_WB|). `error_bound`: of
/// the solution found; what is beyond it is rounding. `residual`: the part of xB - xA that is not along the normal.
/// `iterations`: evaluations of the equations. `singular`: the Jacobian
/// was, or a gradient vanished.
///
/// A seed whose status is not `usable` is answered with `not_converged` after no iteration. Throws
/// std::invalid_argument if check_seed does, else never; does not allocate.
template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
DistanceResult newton_distance(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                               NewtonSystem system, const WitnessPair& seed, const NewtonOptions& options = {});

/// The same, compiled into the library.
GEOM_EXPORT DistanceResult newton_distance(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                                           NewtonSystem system, const WitnessPair& seed,
                                           const NewtonOptions& options = {});

/// Throws std::invalid_argument if a `usable` seed has a point that is not finite, or that lies inside its body by more
/// than kMaxSeedDepth (relative to its distance from the body's centre; to first order, -f / |f_x|).
template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
void check_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const WitnessPair& seed);

/// The seed, or a declined one if check_seed would refuse it. Never throws.
template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
WitnessPair checked_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const WitnessPair& seed);

/// The points where the line of centres leaves A and enters B: crude. Declined if the centres coincide, or a centre is
/// not inside its body. Relative accuracy of the points 1e-9. Takes 0.3 microseconds for ellipsoids, 3 for
/// superellipsoids. Newton's method converges from these points for 99.8 % of the pairs of ellipsoids with eight
/// equations and 96.5 % with five (82 % at X0 = 0.1), of superellipsoids for 99.2 % and 98.3 %. How often it does from
/// each seed: docs/accuracy.md.
template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
WitnessPair centre_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB);

/// The support points of A along n and of B along -n; n in the world frame, of any length. Declined if n is zero or not
/// finite. Takes 0.05 microseconds for ellipsoids, 0.3 for superellipsoids; as good as the normal is.
template <SupportShape ShapeA, SupportShape ShapeB>
WitnessPair normal_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const Eigen::Vector3d& n);

/// The witness points of `distance`; declined where that declines. Takes what that takes, 0.2 to 0.3 microseconds for
/// ellipsoids, 1 to 3 for superellipsoids. Newton's method converges from these points for all pairs of ellipsoids; of
/// superellipsoids for 99.99 % and more with eight equations and 99.97 % with five.
template <SupportShape ShapeA, SupportShape ShapeB>
WitnessPair dual_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB);

namespace kernel {

/// newton_distance for the event loop: never throws. A bad seed leads to a declined answer.
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

/// Whether check_seed accepts the point of a usable seed.
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
