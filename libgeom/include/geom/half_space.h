#pragma once

#include <geom/export.h>
#include <geom/queries.h>

#include <Eigen/Core>

#include <cmath>
#include <utility>

namespace geom {

/// Half-space {x : normal.x <= offset} in the body's frame: a body beyond a plane, such as a floor. It is no
/// SupportShape, as it has no end; the queries below have closed forms, exact to rounding.
class GEOM_EXPORT HalfSpace {
 public:
  /// Constructs a half-space from its outward normal, of any length, and its offset along the unit normal. Throws
  /// std::invalid_argument if the normal is zero, or a number is not finite or beyond kMaxCoordinate.
  explicit HalfSpace(const Eigen::Vector3d& normal = Eigen::Vector3d::UnitZ(), double offset = 0);

  const Eigen::Vector3d& normal() const { return normal_; }  ///< unit outward normal
  double offset() const { return offset_; }                  ///< distance of the plane from the origin along the normal

  /// Returns whether a point is in the half-space or on its surface.
  bool contains(const Eigen::Vector3d& x) const { return normal_.dot(x) <= offset_; }

 private:
  Eigen::Vector3d normal_;
  double offset_;
};

/// Returns the signed distance of a half-space and a body: how far the body's lowest point is above the plane.
/// Overlapping: minus the shortest way out, along the normal. `error_bound` is 0.
template <SupportShape Shape>
DistanceResult distance(const HalfSpace& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                        const DistanceOptions& /*options*/ = {}) {
  const Eigen::Vector3d n = X_WA.rotation() * a.normal();
  const Support s = b.support(X_WB.rotation().transpose() * -n);
  DistanceResult r;
  r.distance = (n.dot(X_WB.position() - X_WA.position()) - a.offset()) - s.height;
  r.normal = n;
  r.point_b = X_WB.to_world(s.point);
  r.point_a = r.point_b - r.distance * n;
  r.residual = 0;
  r.error_bound = 0;
  r.iterations = 1;
  r.status = r.distance >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  return r;
}
/// Overload with the bodies in the other order.
template <SupportShape Shape>
DistanceResult distance(const Shape& a, const Pose& X_WA, const HalfSpace& b, const Pose& X_WB,
                        const DistanceOptions& options = {}) {
  DistanceResult r = distance(b, X_WB, a, X_WA, options);
  std::swap(r.point_a, r.point_b);
  r.normal = -r.normal;
  return r;
}

/// Overload for shapes chosen at run time.
GEOM_EXPORT DistanceResult distance(const HalfSpace& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                    const DistanceOptions& options = {});

/// Returns whether a half-space and a body overlap (touching counts as overlap).
/// @{
template <SupportShape Shape>
Answer overlap(const HalfSpace& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  const double d = distance(a, X_WA, b, X_WB).distance;
  return std::isnan(d) ? Answer::unknown : d <= 0 ? Answer::yes : Answer::no;
}
template <SupportShape Shape>
Answer overlap(const Shape& a, const Pose& X_WA, const HalfSpace& b, const Pose& X_WB) {
  return overlap(b, X_WB, a, X_WA);
}
/// @}

/// Returns the point of the plane that is closest to a point, in the world frame.
GEOM_EXPORT ClosestPoint closest_point(const HalfSpace& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);

/// Returns the first point of origin + t direction, t >= 0, in the half-space, as ray_cast of other bodies does. The
/// lengths involved are the origin's distance from the half-space's frame and the offset.
GEOM_EXPORT RayHit ray_cast(const HalfSpace& shape, const Pose& X_WB, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& direction);

}  // namespace geom
