#pragma once

/// @file
/// Queries other than the distance of two bodies: overlap, a lower bound of the distance, closest point, point inside,
/// ray cast. None of them throws or allocates.

#include <geom/any_shape.h>
#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/export.h>
#include <geom/polyhedron.h>
#include <geom/pose.h>
#include <geom/round_shapes.h>
#include <geom/shape.h>
#include <geom/superellipsoid.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace geom {

/// Returns a lower bound of the distance of two bodies, certain for any direction n (world, from A to B, not zero): the
/// width of the gap between their tangent planes across n, less the rounding error that it may contain
/// (kLowerBoundRounding of the lengths that enter). Negative if the bodies overlap in that projection. The line of
/// centres is a good first n, the normal of the last `distance` a better one. NaN if n is zero or not finite.
template <SupportShape ShapeA, SupportShape ShapeB>
double distance_lower_bound(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                            const Eigen::Vector3d& n);

/// Answer of `overlap`.
enum class Answer {
  no,       ///< certain: the bodies are apart
  yes,      ///< certain, or the bodies touch to rounding
  unknown,  ///< neither answer is certain
};

/// Returns the enumerator's name.
GEOM_EXPORT const char* to_string(Answer answer);

/// Returns whether two bodies overlap (touching counts as overlap). Mostly decided by one support evaluation, across
/// `start` or the line of centres, or by the inscribed spheres; else by `distance`. The answer is `no` by a positive
/// lower bound; `yes` by a point inside both bodies or a negative upper bound (or if the bodies touch to rounding);
/// `unknown` if there is neither.
template <SupportShape ShapeA, SupportShape ShapeB>
Answer overlap(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
               const Eigen::Vector3d& start = Eigen::Vector3d::Zero());

/// Point of a body's surface that is closest to a given point, which may be inside.
struct [[nodiscard]] ClosestPoint {
  /// Signed distance; < 0: the given point is inside, at this depth.
  double distance = std::numeric_limits<double>::quiet_NaN();
  /// Closest point of the surface.
  Eigen::Vector3d point = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Unit outward normal; the given point is point + distance * normal.
  Eigen::Vector3d normal = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  DistanceStatus status = DistanceStatus::not_converged;  ///< `overlapping`: the given point is inside
  /// Error bound (length): distance <= true distance <= distance + error_bound, as in DistanceResult.
  double error_bound = std::numeric_limits<double>::quiet_NaN();
};

/// Returns the closest point of a body's surface, in the world frame. Accuracy, certificates and cost are those of
/// `distance`: points deeper than the smallest radius of curvature need a search over all normals, as deep overlaps do.
/// It takes from a tenth of a millisecond to some tens of milliseconds, most in the middle of long bodies. Declines
/// (`not_converged`) points that are not finite or beyond kMaxCoordinate.
template <SupportShape Shape>
ClosestPoint closest_point(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);
/// Overload compiled into the library.
GEOM_EXPORT ClosestPoint closest_point(const Superellipsoid& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);

/// Returns whether a point (world frame) is in the body or on its surface; false for every point beyond kMaxCoordinate.
template <ImplicitSurface Shape>
bool contains(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);
/// Overload for shapes that tell it themselves.
template <PointSet Shape>
bool contains(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);

/// Outcome of a ray cast.
enum class RayStatus {
  hit,            ///< the ray meets the body at `t`
  missed,         ///< certified: no point of the ray is in the body; or the ray touches it to rounding
  inside,         ///< the ray starts inside: t = 0
  not_converged,  ///< no answer
};

/// Returns the enumerator's name.
GEOM_EXPORT const char* to_string(RayStatus status);

/// First intersection of a ray with a body. World frame.
struct [[nodiscard]] RayHit {
  RayStatus status = RayStatus::not_converged;
  double t = std::numeric_limits<double>::quiet_NaN();  ///< ray parameter, in units of the direction's length
  Eigen::Vector3d point = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Unit outward normal. For `inside` it is that of the surface nearby or, in the centre, the direction against the
  /// ray.
  Eigen::Vector3d normal = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// Returns the first point of origin + t direction, t >= 0, in the body; direction != 0, of any length. World frame.
/// Declines (`not_converged`) if a number is not finite, the direction's length and t included, or the origin is beyond
/// kMaxCoordinate. A ray meets the body if their distance is at most kRayGap times the lengths involved: the bounding
/// radius R plus the distance of the origin from the body's centre, of which no more than about 4 R counts. A ray that
/// starts on the surface therefore meets the body at t = 0, whatever its direction.
///
/// Accuracy, wherever the origin is: `point` is within 1e-13 R of the surface, and within 4 ulp of the largest
/// coordinate of the origin (or of the point, if that is larger) of the ray; both as far as the coordinates of the
/// point and of the body's position can represent it. If the origin is far away, `point` is more accurate than origin +
/// t direction, which is rounded with t. The position along a grazing ray is accurate only to the square root of 1e-14.
///
/// The method starts two radii before the body (exactly, by fused multiply-adds), and advances from tangent plane to
/// tangent plane of the closest points: a step never passes the body, and the last ones converge quadratically.
template <SupportShape Shape>
RayHit ray_cast(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);
/// Overload in closed form, with the same tolerance and accuracy.
GEOM_EXPORT RayHit ray_cast(const Ellipsoid& shape, const Pose& X_WB, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& direction);
/// Overload by Newton's method on the norm whose unit ball the body is, with the same tolerance and accuracy.
GEOM_EXPORT RayHit ray_cast(const Superellipsoid& shape, const Pose& X_WB, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& direction);
/// Overload that casts the ray on the ellipsoid with three equal semi-axes.
inline RayHit ray_cast(const Sphere& shape, const Pose& X_WB, const Eigen::Vector3d& origin,
                       const Eigen::Vector3d& direction) {
  return ray_cast(shape.ellipsoid(), X_WB, origin, direction);
}
/// Overload in closed form: the ray is clipped by the planes of the faces. It meets the body if it stays within kRayGap
/// times the lengths involved of all of them, which at a sharp edge is a little further from the body.
/// @{
GEOM_EXPORT RayHit ray_cast(const Box& shape, const Pose& X_WB, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& direction);
GEOM_EXPORT RayHit ray_cast(const ConvexPolyhedron& shape, const Pose& X_WB, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& direction);
/// @}

/// Returns the last point of origin + t direction, t >= 0, in the body, with the status `hit`, wherever the origin is:
/// the first point of the ray that comes from beyond the body in the opposite direction. `missed` if no point of the
/// ray is in the body. Accuracy and limits are those of `ray_cast`.
template <class Shape>
RayHit ray_exit(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// Overload for shapes chosen at run time.
/// @{
GEOM_EXPORT double distance_lower_bound(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                        const Eigen::Vector3d& n);
GEOM_EXPORT Answer overlap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                           const Eigen::Vector3d& start = Eigen::Vector3d::Zero());
GEOM_EXPORT ClosestPoint closest_point(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);
GEOM_EXPORT bool contains(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);
GEOM_EXPORT RayHit ray_cast(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& direction);
/// @}

}  // namespace geom

#include <geom/kernel/queries_impl.h>
