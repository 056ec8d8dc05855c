#pragma once

#include <geom/mass.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace geom {
namespace kernel {

/// Node of the tanh-sinh rule on (0, 1).
struct QuadratureNode {
  double x, complement, weight;  ///< complement = 1 - x, without cancellation
};

/// Returns the node at t for nodes that are `step` apart in t.
inline QuadratureNode tanh_sinh_node(double t, double step) {
  const double u = std::numbers::pi * std::sinh(t);
  const double x = 1 / (1 + std::exp(-u));
  const double complement = 1 / (1 + std::exp(u));
  return {x, complement, step * std::numbers::pi * std::cosh(t) * x * complement};
}

/// Returns the distance of the surface along the unit vector n, by Newton's method from outside, which is monotone for
/// a convex f.
template <class Shape>
double surface_radius(const Shape& shape, const Eigen::Vector3d& n, double bounding_radius) {
  constexpr int kMostSteps = 200;
  double r = bounding_radius;
  for (int k = 0; k < kMostSteps; ++k) {
    const double step = shape.value(r * n) / n.dot(shape.gradient(r * n));
    r -= step;
    if (!(std::abs(step) > 1e-15 * r)) break;
  }
  return r;
}

/// Integrates with 2 half + 1 nodes an angle; the last ones are 1e-17 from the ends.
template <class Shape>
MassProperties quadrature(const Shape& shape, double bounding_radius, int half) {
  constexpr double kQuarter = std::numbers::pi / 2;
  const double step = 3.4 / half;
  MassProperties mass;
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (int i = -half; i <= half; ++i) {
    const QuadratureNode theta = tanh_sinh_node(step * i, step);
    for (int j = -half; j <= half; ++j) {
      const QuadratureNode phi = tanh_sinh_node(step * j, step);
      // Sines are computed from the nearer end: the last nodes are closer to it than rounding.
      const double sin_theta = std::sin(kQuarter * theta.x);
      const Eigen::Vector3d n(sin_theta * std::sin(kQuarter * phi.complement), sin_theta * std::sin(kQuarter * phi.x),
                              std::sin(kQuarter * theta.complement));
      const double weight = kQuarter * kQuarter * theta.weight * phi.weight * sin_theta;
      for (unsigned octant = 0; octant < 8; ++octant) {
        const Eigen::Vector3d m((octant & 1U) != 0 ? -n.x() : n.x(), (octant & 2U) != 0 ? -n.y() : n.y(),
                                (octant & 4U) != 0 ? -n.z() : n.z());
        const double r = surface_radius(shape, m, bounding_radius);
        mass.volume += weight * r * r * r / 3;
        mass.first_moment += weight * r * r * r * r / 4 * m;
        second += weight * r * r * r * r * r / 5 * m * m.transpose();
      }
    }
  }
  mass.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return mass;
}

}  // namespace kernel

template <ImplicitSurface Shape>
MassProperties mass_properties(const Shape& shape, double bounding_radius, double tolerance) {
  constexpr int kLeastNodes = 20;
  constexpr int kMostNodes = 320;
  MassProperties coarse = kernel::quadrature(shape, bounding_radius, kLeastNodes);
  for (int half = 2 * kLeastNodes;; half *= 2) {
    MassProperties fine = kernel::quadrature(shape, bounding_radius, half);
    fine.relative_error = std::max(std::abs(fine.volume - coarse.volume) / fine.volume,
                                   (fine.inertia - coarse.inertia).norm() / fine.inertia.norm());
    if (fine.relative_error <= tolerance || half >= kMostNodes) return fine;
    coarse = fine;
  }
}

}  // namespace geom
