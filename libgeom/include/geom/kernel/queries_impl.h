#pragma once

#include <geom/queries.h>

namespace geom {
namespace kernel {

/// Returns v / |v|, also if |v|^2 under- or overflows; NaN if v is zero or not finite.
inline Eigen::Vector3d unit_vector(const Eigen::Vector3d& v) {
  const double v2 = v.squaredNorm();
  constexpr double kMost2 = 1e300;  // below overflow
  if (v2 > kLeastStart2 && v2 < kMost2) [[likely]]
    return v / std::sqrt(v2);
  const Eigen::Vector3d scaled = v / v.cwiseAbs().maxCoeff();
  return scaled / scaled.norm();
}

/// Start of a ray near a body, and the ray's parameter there.
struct NearRay {
  Eigen::Vector3d origin;
  double t = 0;
};

/// Maximum number of steps of near_ray(): coordinates up to kMaxCoordinate, semi-axes down to kMinSemiAxis, and a step
/// that is accurate to 1e-15 of its length.
inline constexpr int kMaxRayApproaches = 16;

/// Moves the origin of a ray that starts far away to about two bounding radii before it is closest to the body's
/// centre, so that neither the step into the surface nor the tolerance there is rounded with the length of the way. The
/// new origin is the point of the ray, for the direction as given (not normalised), rounded once to its own coordinates
/// (a step from beyond 1e15 radii takes more than one, and is rounded to the coordinates on the way). A ray that starts
/// near, or leads away, is not changed.
inline NearRay near_ray(const Eigen::Vector3d& centre, double radius, const Eigen::Vector3d& origin,
                        const Eigen::Vector3d& direction) {
  int exponent = 0;
  std::frexp(direction.cwiseAbs().maxCoeff(), &exponent);
  Eigen::Vector3d d;  // scaled by a power of two, exactly: lengths of any direction neither under- nor overflow
  for (int k = 0; k < 3; ++k) d[k] = std::ldexp(direction[k], -exponent);
  const double length = d.norm();
  NearRay ray{origin};
  for (int step = 0; step < kMaxRayApproaches; ++step) {
    const double ahead = (centre - ray.origin).dot(d) / length - 2 * radius;
    if (step == 0 ? !(ahead > 2 * radius) : std::abs(ahead) <= 0.5 * radius) break;
    const double t = ahead / length;
    for (int k = 0; k < 3; ++k) ray.origin[k] = std::fma(t, d[k], ray.origin[k]);
    ray.t += std::ldexp(t, -exponent);
  }
  return ray;
}

/// Returns the bounding radius of a shape of either form.
template <class Shape>
double bounding_radius_of(const Shape& shape) {
  if constexpr (requires { shape.bounding_radius(); }) {
    return shape.bounding_radius();
  } else {
    return bounding_radius(shape);
  }
}

/// Returns whether a point's coordinates are finite and as small as those of a Pose.
inline bool is_within_reach(const Eigen::Vector3d& p_W) {
  return (p_W.array().abs() <= kMaxCoordinate).all();
}

/// Returns the closest point from the distance of a ball of that radius about the point, as body A, to the shape, as
/// body B.
inline ClosestPoint closest_point_from(const Eigen::Vector3d& p_W, const DistanceResult& r, double radius) {
  ClosestPoint closest;
  closest.distance = r.distance + radius;             // exact for any radius: support functions are additive
  closest.point = p_W + closest.distance * r.normal;  // any mismatch of the support points is assigned to the shape
  closest.normal = -r.normal;
  closest.error_bound = r.error_bound;
  closest.status = r.status;
  if (closest.status == DistanceStatus::overlapping && closest.distance >= 0)
    closest.status = DistanceStatus::separated;
  return closest;
}

/// Returns what is certain from an answer of `distance`: apart, by a positive lower bound; overlapping, by a negative
/// upper bound or a point inside both bodies, or touching to rounding.
template <class ShapeA, class ShapeB>
Answer certain_answer(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const DistanceResult& d) {
  if (d.status == DistanceStatus::separated) return d.distance > 0 ? Answer::no : Answer::yes;
  if (d.status != DistanceStatus::overlapping) return Answer::unknown;
  if (d.distance + d.error_bound < 0) return Answer::yes;
  if (share_a_point(a, X_WA, b, X_WB, d.point_a, d.point_b)) return Answer::yes;
  const double size = (X_WB.position() - X_WA.position()).norm() + a.bounding_radius() + b.bounding_radius();
  return -d.distance <= kRoundingFactor * size ? Answer::yes : Answer::unknown;
}

}  // namespace kernel

template <SupportShape ShapeA, SupportShape ShapeB>
double distance_lower_bound(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                            const Eigen::Vector3d& n) {
  const Eigen::Vector3d unit = kernel::unit_vector(n);
  const Eigen::Vector3d r = X_WB.position() - X_WA.position();
  const double h_a = Support(a.support(X_WA.rotation().transpose() * unit)).height;
  const double h_b = Support(b.support(X_WB.rotation().transpose() * -unit)).height;
  const double lengths = r.norm() + a.bounding_radius() + b.bounding_radius();
  return unit.dot(r) - h_a - h_b - kLowerBoundRounding * lengths;
}

template <ImplicitSurface Shape>
bool contains(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& p_W) {
  return kernel::is_within_reach(p_W) && shape.value(X_WB.to_body(p_W)) <= 0;
}

template <PointSet Shape>
bool contains(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& p_W) {
  return kernel::is_within_reach(p_W) && shape.contains(X_WB.to_body(p_W));
}

template <SupportShape ShapeA, SupportShape ShapeB>
Answer overlap(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const Eigen::Vector3d& start) {
  const Eigen::Vector3d r = X_WB.position() - X_WA.position();
  const double inscribed = a.inscribed_radius() + b.inscribed_radius();
  if (r.squaredNorm() <= inscribed * inscribed) return Answer::yes;
  if (distance_lower_bound(a, X_WA, b, X_WB, kernel::is_warm(start) ? start : r) > 0) return Answer::no;
  if (kernel::share_the_middle(a, X_WA, b, X_WB)) return Answer::yes;
  const DistanceResult local = distance(a, X_WA, b, X_WB, {.start = start, .penetration = Penetration::local});
  const Answer answer = kernel::certain_answer(a, X_WA, b, X_WB, local);
  if (answer != Answer::unknown) return answer;
  return kernel::certain_answer(a, X_WA, b, X_WB, distance(a, X_WA, b, X_WB));
}

template <SupportShape Shape>
ClosestPoint closest_point(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& p_W) {
  if (!kernel::is_within_reach(p_W)) return {};
  return kernel::closest_point_from(p_W, distance(kernel::Point(), Pose::translation(p_W), shape, X_WB), 0);
}

template <SupportShape Shape>
RayHit ray_cast(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  RayHit hit;
  const Eigen::Vector3d u = kernel::unit_vector(direction);
  const double speed = direction.dot(u);
  if (!kernel::is_within_reach(origin) || !std::isfinite(speed)) return hit;
  const kernel::NearRay near = kernel::near_ray(X_WB.position(), shape.bounding_radius(), origin, direction);
  const double touching = kRayGap * (shape.bounding_radius() + (near.origin - X_WB.position()).norm());
  const bool starts_here = near.t == 0;
  double way = 0;
  for (int step = 0; step < kMaxRaySteps; ++step) {
    const ClosestPoint closest = closest_point(shape, X_WB, near.origin + way * u);
    if (closest.status != DistanceStatus::separated && closest.status != DistanceStatus::overlapping) return hit;
    if (closest.distance <= touching) {
      const double t = near.t + way / speed;
      if (!std::isfinite(t)) return hit;
      const bool inside = starts_here && step == 0 && closest.distance < 0;
      hit = {inside ? RayStatus::inside : RayStatus::hit, t, near.origin + way * u, closest.normal};
      return hit;
    }
    const double approach = -closest.normal.dot(u);
    // The body has no point above its tangent plane.
    if (!(approach > kRayApproach)) {
      hit.status = RayStatus::missed;
      return hit;
    }
    way += closest.distance / approach;
  }
  return hit;
}

template <class Shape>
RayHit ray_exit(const Shape& shape, const Pose& X_WB, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  RayHit exit;
  const Eigen::Vector3d u = kernel::unit_vector(direction);
  const double speed = direction.dot(u);
  if (!kernel::is_within_reach(origin) || !std::isfinite(speed)) return exit;
  const double ahead = (X_WB.position() - origin).dot(u);
  const double beyond = ahead + 2 * kernel::bounding_radius_of(shape);
  if (!(beyond > 0)) {
    exit.status = RayStatus::missed;
    return exit;
  }
  const RayHit back = ray_cast(shape, X_WB, Eigen::Vector3d(origin + beyond * u), Eigen::Vector3d(-u));
  if (back.status != RayStatus::hit) {
    exit.status = back.status;
    return exit;
  }
  const double touching = kRayGap * (kernel::bounding_radius_of(shape) + std::abs(ahead));
  const double way = beyond - back.t;
  if (way < -touching) {
    exit.status = RayStatus::missed;  // the body is behind the origin
    return exit;
  }
  const double t = std::max(way, 0.0) / speed;
  if (!std::isfinite(t)) return exit;
  return {RayStatus::hit, t, back.point, back.normal};
}

}  // namespace geom
