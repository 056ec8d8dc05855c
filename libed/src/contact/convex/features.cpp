#include "contact/convex/features.h"

#include <Eigen/Geometry>

namespace ed::internal {

using Eigen::Vector3d;

Vector3d turning_of_normal(const ConvexFeatures& features, const Vector3d& n, double distance, const Vector3d& v,
                           const Vector3d& omega_a, const Vector3d& omega_b) {
  const auto velocity = [&](const Vector3d& a, const Vector3d& b) {
    return Vector3d(v + omega_b.cross(b) - omega_a.cross(a));
  };
  const auto edge = [&](std::size_t k) {
    return Vector3d((features.b[k] - features.b[0]) - (features.a[k] - features.a[0]));
  };
  const auto edge_velocity = [&](std::size_t k) {
    return Vector3d(omega_b.cross(features.b[k] - features.b[0]) - omega_a.cross(features.a[k] - features.a[0]));
  };
  Vector3d rate = Vector3d::Zero();
  if (features.count == 3) {
    const Vector3d e = edge(1);
    const Vector3d f = edge(2);
    const Vector3d c = e.cross(f);
    const double c2 = c.squaredNorm();
    if (!(c2 > 1e-24 * e.squaredNorm() * f.squaredNorm())) return Vector3d::Zero();
    rate = (-n.dot(edge_velocity(1)) / c2) * f.cross(c) + (-n.dot(edge_velocity(2)) / c2) * c.cross(e);
  } else if (features.count > 0) {
    const Vector3d x = velocity(features.point_a(), features.point_b());
    if (!(distance > 0)) return Vector3d::Zero();
    if (features.count == 1) {
      rate = x / distance;
    } else {
      const Vector3d e = edge(1);
      const Vector3d b = n.cross(e);
      const double e2 = e.squaredNorm();
      rate = (-n.dot(edge_velocity(1)) / e2) * e + (x.dot(b) / (distance * e2)) * b;
    }
  }
  return n.cross(rate);
}

}  // namespace ed::internal
