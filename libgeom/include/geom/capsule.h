#pragma once

#include <geom/export.h>
#include <geom/kernel/core.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <optional>
#include <string>

namespace geom {

/// Capsule (spherocylinder): all points within `radius` of the segment from -half_length to half_length along z.
class GEOM_EXPORT Capsule {
 public:
  /// Throws std::invalid_argument unless the radius is within [kMinSemiAxis, kMaxSemiAxis], 1e-50 to 1e50, and the
  /// half-length at least 0, its sum with the radius within that range and at most kMaxAspectRatio, 1e4, times the
  /// radius.
  Capsule(double half_length, double radius);

  double half_length() const { return half_length_; }  ///< half the distance of the centres of the caps
  double radius() const { return radius_; }            ///< radius of the caps and of the cylinder between them

  std::optional<int> symmetry_axis() const { return 2; }  ///< axis of revolution: z
  bool has_vertices() const { return false; }  ///< whether the second derivatives of f are unbounded on the surface
  /// Returns the capsule of `factor` times the size. Throws as the constructor does.
  Capsule scaled(double factor) const { return {factor * half_length_, factor * radius_}; }
  /// Returns "capsule of half-length 2 and radius 0.5", for messages.
  std::string description() const;

  /// Returns f(x) = (distance of x from the segment / radius)^2 - 1: negative inside. Its gradient is continuous, its
  /// Hessian jumps where the caps begin.
  double value(const Eigen::Vector3d& x) const { return (from_segment(x) / radius_).squaredNorm() - 1; }
  Eigen::Vector3d gradient(const Eigen::Vector3d& x) const;  ///< gradient of f
  Eigen::Matrix3d hessian(const Eigen::Vector3d& x) const;   ///< Hessian of f

  /// Returns h(n) = half_length |n_z| + radius |n|, with a kink at n_z = 0, and the support point; n != 0, any length.
  Support support(const Eigen::Vector3d& n) const { return kernel::swept_support(core(), n); }
  /// Returns hess h away from the kink, that of the ball.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const { return kernel::ball_hessian(radius_, n); }

  double bounding_radius() const { return half_length_ + radius_; }  ///< half_length + radius
  double inscribed_radius() const { return radius_; }                ///< the radius
  double min_curvature_radius() const { return radius_; }            ///< the radius
  double volume() const;                                             ///< pi radius^2 (2 half_length + 4 radius / 3)
  /// Returns the principal moments of inertia about body x, y, z at uniform density.
  Eigen::Vector3d inertia(double mass) const;

  /// Returns the segment as a core.
  kernel::CoreView core() const {
    return {.kind = kernel::CoreKind::segment,
            .half = {0, 0, half_length_},
            .radius = radius_,
            .bounding_radius = half_length_};
  }

 private:
  Eigen::Vector3d from_segment(const Eigen::Vector3d& x) const;

  double half_length_;
  double radius_;
};

}  // namespace geom
