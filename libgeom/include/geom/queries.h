#pragma once

/// @file
/// Questions other than the distance of two bodies: do they overlap, at least how far apart are they, what is the
/// closest point, is a point inside, what does a ray hit. All of them never throw and never allocate.

#include <geom/any_shape.h>
#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/export.h>
#include <geom/pose.h>
#include <geom/shape.h>
#include <geom/superellipsoid.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace geom {

/// A lower bound of the distance of two bodies, certain whatever the direction n (world, from A to B, not zero): the
/// width of the gap between their tangent planes across n, less what rounding can have added to it (kLowerBoundRounding
/// of the lengths that enter). Negative where they overlap in that projection. The line of centres is a good first n,
/// the normal of the last `distance` a better one. NaN if n is zero or not finite.
template <SupportShape ShapeA, SupportShape ShapeB>
double distance_lower_bound(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                            const Eigen::Vector3d& n);

/// The answer of `overlap`.
enum class Answer {
  no,       ///< certain: they are apart
  yes,      ///< certain, or they touch to rounding
  unknown,  ///< neither is certain
};

/// The enumerator's name.
GEOM_EXPORT const char* to_string(Answer answer);

/// Whether two bodies overlap (touching counts as overlap). Mostly decided by one support evaluation, across `start` or
/// the line of centres, or by the inscribed spheres; else by `distance`: `no` by a positive lower bound, `yes` by a
/// point that both bodies hold or a negative upper bound (or where they touch to rounding), `unknown` where there is
/// neither.
template <SupportShape ShapeA, SupportShape ShapeB>
Answer overlap(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
               const Eigen::Vector3d& start = Eigen::Vector3d::Zero());

/// The point of a body that is closest to a point, which may be inside.
struct [[nodiscard]] ClosestPoint {
  double distance = std::numeric_limits<double>::quiet_NaN();  ///< < 0: the point is inside, by so much
  Eigen::Vector3d point = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());  ///< of the surface
  /// Unit, outward: the point asked for is point + distance * normal.
  Eigen::Vector3d normal = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  DistanceStatus status = DistanceStatus::not_converged;  ///< `overlapping`: inside
  /// Length: distance <= true distance <= distance + error_bound, as DistanceResult's.
  double error_bound = std::numeric_limits<double>::quiet_NaN();
};

/// World frame; accuracy and certificates as those of `distance`, and its cost: points deeper than the smallest radius
/// of curvature take a search over all normals, as deep overlaps do: a tenth of a millisecond to some tens of them,
/// most in the middle of long bodies. Declined (`not_converged`) for points that are not finite or beyond
/// kMaxCoordinate.
template <SupportShape Shape>
ClosestPoint closest_point(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);
/// The same, compiled into the library.
GEOM_EXPORT ClosestPoint closest_point(const Superellipsoid& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);

/// Whether a point of the world is in the body or on its surface. No point beyond kMaxCoordinate is.
template <ImplicitSurface Shape>
bool contains(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);

/// What became of a ray.
enum class RayStatus {
  hit,            ///< at `t`
  missed,         ///< certified: no point of the ray is in the body, or touches it to rounding
  inside,         ///< the ray starts inside: t = 0
  not_converged,  ///< no answer
};

/// The enumerator's name.
GEOM_EXPORT const char* to_string(RayStatus status);

/// Where a ray meets a body. World frame.
struct [[nodiscard]] RayHit {
  RayStatus status = RayStatus::not_converged;
  double t = std::numeric_limits<double>::quiet_NaN();  ///< in units of the direction's length
  Eigen::Vector3d point = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Unit, outward. `inside`: of the surface nearby, or, in the centre, against the ray.
  Eigen::Vector3d normal = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

/// The first point of origin + t direction, t >= 0, in the body; direction != 0, of any length. World frame. Declined
/// (`not_converged`) if a number is not finite, the direction's length and t included, or the origin beyond
/// kMaxCoordinate. A ray meets the body where their distance is no larger than kRayGap times the lengths involved, the
/// bounding radius R and the distance of the origin from the body's centre, of which no more than about 4 R counts: one
/// that starts on the surface does at t = 0, whatever its direction.
///
/// Accuracy, wherever the origin is: `point` is within 1e-13 R of the surface, and within 4 ulp of the largest
/// coordinate of the origin (or of the point, if that is larger) of the ray; both as far as the coordinates of the
/// point and of the body's position can hold it. From afar, `point` is more exact than origin + t direction, which is
/// rounded with t. Where along the ray a grazing one meets the body is known to the square root of 1e-14 only.
///
/// Starts two radii before the body (exactly, by fused multiply-adds), and advances from tangent plane to tangent plane
/// of the closest points: a step never passes the body, and the last ones converge quadratically.
template <SupportShape Shape>
RayHit ray_cast(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);
/// Overload in closed form, with the same tolerance and accuracy.
GEOM_EXPORT RayHit ray_cast(const Ellipsoid& shape, const Pose& X_WB, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& direction);

/// The same for shapes chosen at run time.
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
