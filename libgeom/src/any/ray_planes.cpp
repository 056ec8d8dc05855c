#include <geom/queries.h>

#include <cstddef>

namespace geom {
namespace {

using Eigen::Vector3d;

/// Face of a polytope: normal.x <= offset.
struct Plane {
  Vector3d normal;
  double offset;
};

/// Ray clipped by planes, one after the other.
struct ClippedRay {
  double enter = -std::numeric_limits<double>::infinity();
  double enter_near = enter;  ///< way to where it comes within `touching` of the last plane
  double exit_near = std::numeric_limits<double>::infinity();
  double highest = enter;  ///< largest height of the origin above a plane
  Vector3d normal = Vector3d::Zero();
  Vector3d highest_normal = Vector3d::Zero();

  void clip(const Plane& plane, const Vector3d& o, const Vector3d& d, double touching) {
    const double height = plane.normal.dot(o) - plane.offset;
    const double slope = plane.normal.dot(d);
    if (height > highest) {
      highest = height;
      highest_normal = plane.normal;
    }
    if (std::abs(slope) <= kRayApproach) {
      if (height > touching) exit_near = -std::numeric_limits<double>::infinity();
    } else if (slope < 0) {
      const double way = height / -slope;
      if (way > enter) {
        enter = way;
        normal = plane.normal;
      }
      enter_near = std::max(enter_near, (height - touching) / -slope);
    } else {
      exit_near = std::min(exit_near, (touching - height) / slope);
    }
  }
};

/// Casts a ray on the polytope of planes plane(0) to plane(count - 1).
template <class PlaneOf>
RayHit cast_on_planes(std::size_t count, const PlaneOf& plane, double bounding_radius, const Pose& X_WB,
                      const Vector3d& origin, const Vector3d& direction) {
  RayHit hit;
  const Vector3d u = kernel::unit_vector(direction);
  const double speed = direction.dot(u);
  if (!kernel::is_within_reach(origin) || !std::isfinite(speed)) return hit;
  const kernel::NearRay near = kernel::near_ray(X_WB.position(), bounding_radius, origin, direction);
  const double touching = kRayGap * (bounding_radius + (near.origin - X_WB.position()).norm());
  const Vector3d o = X_WB.to_body(near.origin);
  const Vector3d d = X_WB.rotation().transpose() * u;
  ClippedRay ray;
  for (std::size_t k = 0; k < count; ++k) ray.clip(plane(k), o, d, touching);
  const auto at = [&](RayStatus status, double way, const Vector3d& normal) {
    const double t = near.t + way / speed;
    if (!std::isfinite(t)) return RayHit();
    return RayHit{status, t, near.origin + way * u, X_WB.rotation() * normal};
  };
  if (ray.highest <= touching) {
    return at(ray.highest < 0 && near.t == 0 ? RayStatus::inside : RayStatus::hit, 0, ray.highest_normal);
  }
  if (!(ray.enter_near <= ray.exit_near) || !(ray.exit_near >= 0)) {
    hit.status = RayStatus::missed;
    return hit;
  }
  return at(RayStatus::hit, std::max(0.0, ray.enter), ray.normal);
}

}  // namespace

RayHit ray_cast(const Box& shape, const Pose& X_WB, const Vector3d& origin, const Vector3d& direction) {
  const auto plane = [&](std::size_t k) {
    const auto axis = static_cast<Eigen::Index>(k / 2);
    return Plane{(k % 2 == 0 ? 1 : -1) * Vector3d::Unit(axis), shape.half_extents()[axis]};
  };
  return cast_on_planes(6, plane, shape.bounding_radius(), X_WB, origin, direction);
}

RayHit ray_cast(const ConvexPolyhedron& shape, const Pose& X_WB, const Vector3d& origin, const Vector3d& direction) {
  const kernel::Hull& hull = *shape.core().hull;
  const auto plane = [&](std::size_t k) { return Plane{hull.normals[k], hull.offsets[k]}; };
  return cast_on_planes(hull.normals.size(), plane, shape.bounding_radius(), X_WB, origin, direction);
}

}  // namespace geom
