#pragma once

/// User-defined body given by an equation, and pairs of such bodies whose distance is known by construction.

#include "common/geom/manufactured.h"
#include "common/geom/random.h"

#include <geom/geom.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace geom_test {

/// Body {|x/a|^n + |y/b|^m + |z/c|^p <= 1}: convex for exponents >= 1, its Hessian finite for exponents >= 2.
struct PowerBody {
  Eigen::Vector3d semi_axes;
  Eigen::Vector3d exponents;

  double value(const Eigen::Vector3d& x) const {
    double sum = -1;
    for (int i = 0; i < 3; ++i) sum += std::pow(std::abs(x[i] / semi_axes[i]), exponents[i]);
    return sum;
  }
  Eigen::Vector3d gradient(const Eigen::Vector3d& x) const {
    Eigen::Vector3d g;
    for (int i = 0; i < 3; ++i) {
      const double slope = exponents[i] / semi_axes[i] * std::pow(std::abs(x[i] / semi_axes[i]), exponents[i] - 1);
      g[i] = std::copysign(slope, x[i]);
    }
    return g;
  }
  Eigen::Matrix3d hessian(const Eigen::Vector3d& x) const {
    Eigen::Vector3d h;
    for (int i = 0; i < 3; ++i) {
      h[i] = exponents[i] * (exponents[i] - 1) / (semi_axes[i] * semi_axes[i]) *
             std::pow(std::abs(x[i] / semi_axes[i]), exponents[i] - 2);
    }
    return h.asDiagonal();
  }
};

/// Returns a rotation that turns the unit vector `from` to `to`, by any angle about the latter.
inline Eigen::Matrix3d turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to, Random& random) {
  const Eigen::AngleAxisd spin(random.uniform(0, 6.283185307179586), to);
  return (spin * Eigen::Quaterniond::FromTwoVectors(from, to)).normalized().toRotationMatrix();
}

/// Returns a point of the surface, in the body's frame, where a random ray from the centre leaves it.
template <geom::ImplicitSurface Shape>
Eigen::Vector3d random_surface_point(const Shape& shape, Random& random) {
  const Eigen::Vector3d u = random.direction();
  Eigen::Vector3d x = geom::kernel::ray_exit(shape, u, 1.0) * u;
  // ray_exit is accurate to 1e-9; two Newton steps along the ray reduce that to rounding.
  for (int i = 0; i < 2; ++i) x -= shape.value(x) / shape.gradient(x).dot(u) * u;
  return x;
}

struct ManufacturedSurfaces {
  ManufacturedPair pair;
  Eigen::Vector3d point_a;  ///< witness points, world frame
  Eigen::Vector3d point_b;
};

/// Turns and places B so that a random point of its surface faces one of A's at `distance` along the common normal.
///
/// Exact up to rounding for distance >= 0: the bodies lie on either side of two parallel planes.
template <geom::ImplicitSurface ShapeA, geom::ImplicitSurface ShapeB>
ManufacturedSurfaces manufacture_surfaces(const ShapeA& a, const ShapeB& b, double distance, Random& random) {
  const Eigen::Vector3d x_a = random_surface_point(a, random);
  const Eigen::Vector3d x_b = random_surface_point(b, random);
  const geom::Pose X_WA = random.pose(1.0);
  const Eigen::Vector3d n = X_WA.rotation() * a.gradient(x_a).normalized();
  const Eigen::Matrix3d R_b = turn(b.gradient(x_b).normalized(), -n, random);
  const Eigen::Vector3d p_a = X_WA.to_world(x_a);
  const Eigen::Vector3d p_b = p_a + distance * n;
  const geom::Pose X_WB(R_b, p_b - R_b * x_b);
  const double size = (X_WB.position() - X_WA.position()).norm() + x_a.norm() + x_b.norm();
  return {{X_WA, X_WB, n, distance, size}, p_a, p_b};
}

}  // namespace geom_test
