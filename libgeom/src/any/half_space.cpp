#include <geom/half_space.h>
#include <geom/kernel/any_body.h>
#include <geom/kernel/refuse.h>

#include "shapes/format.h"

#include <string>

namespace geom {

using Eigen::Vector3d;

HalfSpace::HalfSpace(const Vector3d& normal, double offset) : normal_(kernel::unit_vector(normal)), offset_(offset) {
  if (!normal_.allFinite()) {
    kernel::refuse("HalfSpace: normal is (" + kernel::shown(normal.x()) + ", " + kernel::shown(normal.y()) + ", " +
                   kernel::shown(normal.z()) + "); accepted: finite, not zero");
  }
  if (!(std::abs(offset) <= kMaxCoordinate)) {
    kernel::refuse("HalfSpace: offset is " + kernel::shown(offset) + "; accepted: magnitudes up to " +
                   kernel::shown(kMaxCoordinate));
  }
}

DistanceResult distance(const HalfSpace& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  return kernel::with_body(b, [&](const auto& s) { return distance(a, X_WA, s, X_WB, options); });
}

ClosestPoint closest_point(const HalfSpace& shape, const Pose& X_WB, const Vector3d& p_W) {
  ClosestPoint closest;
  if (!kernel::is_within_reach(p_W)) return closest;
  closest.normal = X_WB.rotation() * shape.normal();
  closest.distance = closest.normal.dot(p_W - X_WB.position()) - shape.offset();
  closest.point = p_W - closest.distance * closest.normal;
  closest.status = closest.distance >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  closest.error_bound = 0;
  return closest;
}

RayHit ray_cast(const HalfSpace& shape, const Pose& X_WB, const Vector3d& origin, const Vector3d& direction) {
  RayHit hit;
  const Vector3d u = kernel::unit_vector(direction);
  const double speed = direction.dot(u);
  const ClosestPoint closest = closest_point(shape, X_WB, origin);
  if (closest.status == DistanceStatus::not_converged || !std::isfinite(speed)) return hit;
  const double touching = kRayGap * ((origin - X_WB.position()).norm() + std::abs(shape.offset()));
  const double approach = -closest.normal.dot(u);
  if (closest.distance <= touching) {
    return {closest.distance < 0 ? RayStatus::inside : RayStatus::hit, 0, origin, closest.normal};
  }
  if (!(approach > kRayApproach)) {
    hit.status = RayStatus::missed;
    return hit;
  }
  const double way = closest.distance / approach;
  if (!std::isfinite(way / speed)) return hit;
  return {RayStatus::hit, way / speed, origin + way * u, closest.normal};
}

}  // namespace geom
