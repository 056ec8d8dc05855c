#include <geom/queries.h>
#include <geom/superellipsoid.h>

#include <Eigen/Core>

#include <cmath>

namespace geom {
namespace {

using Eigen::Vector3d;

/// Largest number of steps: they converge quadratically, on grazing rays and at vertices by halves.
constexpr int kMostNewtonSteps = 200;

/// Norm N whose unit ball the body is, and its gradient.
struct NormAt {
  NormAt(const Superellipsoid& shape, const Vector3d& x) : gradient(0.5 * shape.gradient(x)) {
    norm = std::sqrt(x.dot(gradient));  // f + 1 = N^2 is homogeneous: x.grad f = 2 N^2
    if (norm > 0) gradient /= norm;
  }

  double norm;
  Vector3d gradient;
};

}  // namespace

RayHit ray_cast(const Superellipsoid& shape, const Pose& X_WB, const Vector3d& origin, const Vector3d& direction) {
  RayHit hit;
  const Vector3d u = kernel::unit_vector(direction);
  const double speed = direction.dot(u);
  if (!kernel::is_within_reach(origin) || !std::isfinite(speed)) return hit;
  const kernel::NearRay near = kernel::near_ray(X_WB.position(), shape.bounding_radius(), origin, direction);
  const Vector3d o = X_WB.to_body(near.origin), d = X_WB.rotation().transpose() * u;
  const double touching = kRayGap * (shape.bounding_radius() + (near.origin - X_WB.position()).norm());
  double way = 0;
  for (int step = 0; step < kMostNewtonSteps; ++step) {
    const NormAt at(shape, o + way * d);
    const double slope = at.gradient.dot(d);
    // N is convex: its tangent is below it, a step along it never passes the surface, and a point is at least
    // (N - 1) / |grad N| away.
    const double excess = at.norm - 1;
    const double next = way - excess / slope;
    if (excess <= touching * at.gradient.norm() || (slope < 0 && !(next > way))) {
      const double t = near.t + way / speed;
      if (!std::isfinite(t)) return hit;
      const bool is_inside = near.t == 0 && step == 0 && excess < 0;
      const Vector3d outwards = at.norm > 0 ? at.gradient : Vector3d(-d);
      hit = {is_inside ? RayStatus::inside : RayStatus::hit, t, near.origin + way * u,
             X_WB.rotation() * kernel::unit_vector(outwards)};
      return hit;
    }
    if (!(slope < 0)) {
      hit.status = RayStatus::missed;
      return hit;
    }
    way = next;
  }
  return hit;
}

}  // namespace geom
