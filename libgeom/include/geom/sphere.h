#pragma once

#include <geom/ellipsoid.h>
#include <geom/export.h>
#include <geom/kernel/core.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <optional>
#include <string>

namespace geom {

/// Ball {x : |x| <= radius}.
class GEOM_EXPORT Sphere {
 public:
  /// Throws std::invalid_argument unless the radius is within [kMinSemiAxis, kMaxSemiAxis], 1e-50 to 1e50.
  explicit Sphere(double radius);

  double radius() const { return radius_; }  ///< radius of the ball

  std::optional<int> symmetry_axis() const { return 2; }  ///< axis of revolution: z, as every axis is one
  bool has_vertices() const { return false; }  ///< whether the second derivatives of f are unbounded on the surface
  /// Returns the sphere of `factor` times the size. Throws as the constructor does.
  Sphere scaled(double factor) const { return Sphere(factor * radius_); }
  /// Returns "sphere of radius 1", for messages.
  std::string description() const;

  /// Returns f(x) = |x / radius|^2 - 1: negative inside.
  double value(const Eigen::Vector3d& x) const { return (x / radius_).squaredNorm() - 1; }
  Eigen::Vector3d gradient(const Eigen::Vector3d& x) const { return 2 / radius_ * (x / radius_); }  ///< gradient of f
  /// Returns the Hessian of f.
  Eigen::Matrix3d hessian(const Eigen::Vector3d& /*x*/) const {
    return 2 / radius_ / radius_ * Eigen::Matrix3d::Identity();
  }

  /// Returns h(n) = radius |n| and the support point radius n / |n|; n != 0, any length.
  Support support(const Eigen::Vector3d& n) const { return kernel::swept_support(core(), n); }
  /// Returns hess h.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const { return kernel::ball_hessian(radius_, n); }

  double bounding_radius() const { return radius_; }       ///< the radius
  double inscribed_radius() const { return radius_; }      ///< the radius
  double min_curvature_radius() const { return radius_; }  ///< the radius
  double volume() const;                                   ///< 4 pi radius^3 / 3
  /// Returns the moments of inertia at uniform density: 2 m radius^2 / 5, three times.
  Eigen::Vector3d inertia(double mass) const;

  /// Returns the ellipsoid with three equal semi-axes.
  Ellipsoid ellipsoid() const { return Ellipsoid(Eigen::Vector3d::Constant(radius_)); }
  /// Returns the centre as a core.
  kernel::CoreView core() const { return {.radius = radius_}; }

 private:
  double radius_;
};

}  // namespace geom
