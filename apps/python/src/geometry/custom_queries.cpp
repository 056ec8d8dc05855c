#include "geometry/custom_queries.h"

#include <geom/any_shape.h>

#include <variant>

namespace hardbody::python::any {
namespace {

using ed::BodyShape;
using Eigen::Vector3d;
using geom::Pose;

/// Shape of any kind as a geom::SupportShape, so that libgeom's templates are instantiated once.
struct AnySupport {
  const BodyShape& shape;

  geom::Support support(const Vector3d& n) const { return ed::support(shape, n); }
  Eigen::Matrix3d support_hessian(const Vector3d& n) const {
    return std::visit([&n](const auto& s) { return Eigen::Matrix3d(s.support_hessian(n)); }, shape);
  }
  double bounding_radius() const { return ed::bounding_radius(shape); }
  double inscribed_radius() const { return ed::inscribed_radius(shape); }
  double min_curvature_radius() const {
    return std::visit([](const auto& s) { return double{s.min_curvature_radius()}; }, shape);
  }
};

/// Returns libgeom's own shape that a shape is; nullopt for a user's.
std::optional<geom::Shape> built_in(const BodyShape& shape) {
  return std::visit(
      [](const auto& s) -> std::optional<geom::Shape> {
        if constexpr (requires { geom::Shape(s); }) return geom::Shape(s);
        return std::nullopt;
      },
      shape);
}

/// Returns query(a, b) of libgeom's own shapes where both are, else of AnySupport.
template <class Query>
auto of_two(const BodyShape& a, const BodyShape& b, const Query& query) {
  const std::optional<geom::Shape> own_a = built_in(a), own_b = built_in(b);
  return own_a && own_b ? query(*own_a, *own_b) : query(AnySupport{a}, AnySupport{b});
}

template <class Query>
auto of_one(const BodyShape& shape, const Query& query) {
  const std::optional<geom::Shape> own = built_in(shape);
  return own ? query(*own) : query(AnySupport{shape});
}

}  // namespace

geom::DistanceResult distance(const BodyShape& a, const Pose& X_WA, const BodyShape& b, const Pose& X_WB,
                              const geom::DistanceOptions& options) {
  return of_two(a, b, [&](const auto& s, const auto& t) { return geom::distance(s, X_WA, t, X_WB, options); });
}

double distance_lower_bound(const BodyShape& a, const Pose& X_WA, const BodyShape& b, const Pose& X_WB,
                            const Vector3d& n) {
  return of_two(a, b, [&](const auto& s, const auto& t) { return geom::distance_lower_bound(s, X_WA, t, X_WB, n); });
}

geom::Answer overlap(const BodyShape& a, const Pose& X_WA, const BodyShape& b, const Pose& X_WB,
                     const Vector3d& start) {
  return of_two(a, b, [&](const auto& s, const auto& t) { return geom::overlap(s, X_WA, t, X_WB, start); });
}

geom::ClosestPoint closest_point(const BodyShape& shape, const Pose& X_WB, const Vector3d& p_W) {
  return of_one(shape, [&](const auto& s) { return geom::closest_point(s, X_WB, p_W); });
}

std::optional<bool> contains(const BodyShape& shape, const Pose& X_WB, const Vector3d& p_W) {
  if (const std::optional<geom::Shape> own = built_in(shape)) return geom::contains(*own, X_WB, p_W);
  const Vector3d p_B = X_WB.to_body(p_W);
  if (p_B.norm() <= ed::inscribed_radius(shape)) return true;
  if (p_B.norm() > ed::bounding_radius(shape)) return false;
  const geom::ClosestPoint closest = geom::closest_point(AnySupport{shape}, X_WB, p_W);
  if (closest.distance > 0) return false;
  if (closest.distance + closest.error_bound <= 0) return true;
  return std::nullopt;
}

geom::RayHit ray_cast(const BodyShape& shape, const Pose& X_WB, const Vector3d& origin, const Vector3d& direction) {
  return of_one(shape, [&](const auto& s) { return geom::ray_cast(s, X_WB, origin, direction); });
}

}  // namespace hardbody::python::any
