#pragma once

#include <geom/export.h>
#include <geom/kernel/core.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <optional>
#include <string>

namespace geom {

/// Circular cylinder about body z, from -half_length to half_length, with sharp rims.
class GEOM_EXPORT Cylinder {
 public:
  /// Throws std::invalid_argument unless half-length and radius are within [kMinSemiAxis, kMaxSemiAxis], 1e-50 to 1e50,
  /// and neither is more than kMaxAspectRatio, 1e4, times the other.
  Cylinder(double half_length, double radius);

  double half_length() const { return half_length_; }  ///< half the distance of the faces
  double radius() const { return radius_; }            ///< radius of the faces

  std::optional<int> symmetry_axis() const { return 2; }  ///< axis of revolution: z
  /// Returns the cylinder of `factor` times the size. Throws as the constructor does.
  Cylinder scaled(double factor) const { return {factor * half_length_, factor * radius_}; }
  /// Returns "cylinder of half-length 2 and radius 0.5", for messages.
  std::string description() const;

  /// Returns whether a point is in the cylinder or on its surface.
  bool contains(const Eigen::Vector3d& x) const { return kernel::frustum_contains(core(), x); }

  /// Returns h(n) = half_length |n_z| + radius |(n_x, n_y)| and a point of a rim, or the middle of a face if n is along
  /// z; n != 0, any length.
  Support support(const Eigen::Vector3d& n) const { return kernel::core_support(core(), n); }
  /// Returns hess h away from the kinks at n_z = 0 and along z: that of a rim.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const { return kernel::rim_hessian(core(), n); }

  double bounding_radius() const { return bounding_radius_; }  ///< distance of the rims from the origin
  /// Returns the smaller of half-length and radius.
  double inscribed_radius() const { return half_length_ < radius_ ? half_length_ : radius_; }
  double min_curvature_radius() const { return 0; }  ///< 0: rims are sharp
  double volume() const;                             ///< 2 pi radius^2 half_length
  /// Returns the principal moments of inertia about body x, y, z at uniform density.
  Eigen::Vector3d inertia(double mass) const;

  /// Returns the cylinder as a core.
  kernel::CoreView core() const {
    return {.kind = kernel::CoreKind::frustum,
            .disc = {{{-half_length_, radius_}, {half_length_, radius_}}},
            .bounding_radius = bounding_radius_};
  }

 private:
  double half_length_;
  double radius_;
  double bounding_radius_;
};

}  // namespace geom
