#include <geom/kernel/any_body.h>
#include <geom/queries.h>

#include <concepts>
#include <type_traits>
#include <variant>

namespace geom {

using Eigen::Vector3d;

const char* to_string(Answer answer) {
  switch (answer) {
    case Answer::no:
      return "no";
    case Answer::yes:
      return "yes";
    case Answer::unknown:
      return "unknown";
  }
  return "unknown";
}

const char* to_string(RayStatus status) {
  switch (status) {
    case RayStatus::hit:
      return "hit";
    case RayStatus::missed:
      return "missed";
    case RayStatus::inside:
      return "inside";
    case RayStatus::not_converged:
      return "not_converged";
  }
  return "unknown";
}

ClosestPoint closest_point(const Superellipsoid& shape, const Pose& X_WB, const Vector3d& p_W) {
  if (!kernel::is_within_reach(p_W)) return {};
  // The point is treated as a small ball, for the methods that flat faces and edges need.
  const double radius = std::max(1e-25 * shape.inscribed_radius(), kMinSemiAxis);
  return kernel::closest_point_from(
      p_W, distance(Ellipsoid(Vector3d::Constant(radius)), Pose::translation(p_W), shape, X_WB), radius);
}

namespace {

/// Returns the distance along o + way d to the unit ball, improved by Newton's method while that brings the point
/// closer to the surface. If the ball is a flat body, this recovers the digits that the point closest to the centre
/// lost to rounding.
double refined_way(const Vector3d& o, const Vector3d& d, double way) {
  const auto excess = [&](double w) { return (o + w * d).squaredNorm() - 1; };
  double f = excess(way);
  for (int step = 0; step < 3; ++step) {
    const double slope = 2 * (o + way * d).dot(d);
    const double next = way - f / slope;
    if (!(slope < 0) || !(next >= 0)) break;
    const double next_f = excess(next);
    if (!(std::abs(next_f) < std::abs(f))) break;
    way = next;
    f = next_f;
  }
  return way;
}

}  // namespace

RayHit ray_cast(const Ellipsoid& shape, const Pose& X_WB, const Vector3d& origin, const Vector3d& direction) {
  RayHit hit;
  const Vector3d u = kernel::unit_vector(direction);
  const double speed = direction.dot(u);
  if (!kernel::is_within_reach(origin) || !std::isfinite(speed)) return hit;
  const kernel::NearRay near = kernel::near_ray(X_WB.position(), shape.bounding_radius(), origin, direction);
  // These are coordinates in which the body is the unit ball.
  const Vector3d o = X_WB.to_body(near.origin).cwiseQuotient(shape.semi_axes());
  const Vector3d d = (X_WB.rotation().transpose() * u).cwiseQuotient(shape.semi_axes());
  const auto at = [&](RayStatus status, double way) {
    const double t = near.t + way / speed;
    if (!std::isfinite(t)) return;
    const Vector3d at_unit_ball = o + way * d;
    const Vector3d m = at_unit_ball.squaredNorm() > 0 ? kernel::unit_vector(at_unit_ball) : -kernel::unit_vector(d);
    hit = {status, t, near.origin + way * u, X_WB.rotation() * kernel::unit_vector(m.cwiseQuotient(shape.semi_axes()))};
  };
  if (o.squaredNorm() < 1) {
    // Seen from far away, this body is smaller than the rounding of its own coordinates.
    at(near.t == 0 ? RayStatus::inside : RayStatus::hit, 0);
    return hit;
  }
  // f(p) = |p|^2 - 1 is also convex in the world's lengths, where its gradient is 2 p / a: the distance of a point
  // outside is at least f / |2 p / a|, and equal to that to first order near the surface.
  const double touching = kRayGap * (shape.bounding_radius() + (near.origin - X_WB.position()).norm());
  const auto touches = [&](const Vector3d& p) {
    return p.squaredNorm() - 1 <= 2 * touching * p.cwiseQuotient(shape.semi_axes()).stableNorm();
  };
  if (touches(o)) {
    at(RayStatus::hit, 0);
    return hit;
  }
  // The roots are computed from the point of the ray closest to the centre: b^2 - 4 a c would cancel.
  const double t_closest = -o.dot(d) / d.squaredNorm();
  const Vector3d closest = o + t_closest * d;
  if (!(t_closest >= 0) || !touches(closest)) {
    hit.status = RayStatus::missed;
  } else {
    const double rest = std::max(0.0, 1 - closest.squaredNorm());
    at(RayStatus::hit, refined_way(o, d, std::max(0.0, t_closest - std::sqrt(rest) / d.norm())));
  }
  return hit;
}

namespace {

/// Shape whose ray_cast is not the general one of a CoreBody.
template <class T>
concept HasOwnRayCast =
    kernel::SmoothShape<T> || std::same_as<T, Sphere> || std::same_as<T, Box> || std::same_as<T, ConvexPolyhedron>;

}  // namespace

double distance_lower_bound(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, const Vector3d& n) {
  return kernel::with_bodies(a, b,
                             [&](const auto& s, const auto& t) { return distance_lower_bound(s, X_WA, t, X_WB, n); });
}

Answer overlap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, const Vector3d& start) {
  return kernel::with_bodies(a, b, [&](const auto& s, const auto& t) { return overlap(s, X_WA, t, X_WB, start); });
}

ClosestPoint closest_point(const Shape& shape, const Pose& X_WB, const Vector3d& p_W) {
  return kernel::with_body(shape, [&](const auto& s) { return closest_point(s, X_WB, p_W); });
}

bool contains(const Shape& shape, const Pose& X_WB, const Vector3d& p_W) {
  return std::visit([&](const auto& s) { return contains(s, X_WB, p_W); }, shape);
}

RayHit ray_cast(const Shape& shape, const Pose& X_WB, const Vector3d& origin, const Vector3d& direction) {
  return std::visit(
      [&](const auto& s) {
        if constexpr (HasOwnRayCast<std::decay_t<decltype(s)>>) {
          return ray_cast(s, X_WB, origin, direction);
        } else {
          return ray_cast(kernel::CoreBody(s), X_WB, origin, direction);
        }
      },
      shape);
}

}  // namespace geom
