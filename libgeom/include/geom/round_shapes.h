#pragma once

/// @file
/// Shapes with an axis of revolution that have exact distances: spheres, capsules, cylinders and cones.

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

  /// Returns h(n) = radius |n| and the support point radius n / |n|; n as of SupportShape.
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

  /// Returns h(n) = half_length |n_z| + radius |n|, with a kink at n_z = 0, and the support point; n as of
  /// SupportShape.
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
  /// z; n as of SupportShape.
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

/// Circular cone about body z, its apex above its base, with a sharp rim.
class GEOM_EXPORT Cone {
 public:
  /// Constructs a cone with its centre of mass in the origin: the base at z = -height / 4. Throws as the other
  /// constructor does.
  Cone(double height, double radius) : Cone(height, radius, -0.25 * height) {}
  /// Constructs a cone with its base at z = base. Throws std::invalid_argument unless height and radius are within
  /// [kMinSemiAxis, kMaxSemiAxis], 1e-50 to 1e50, the origin is inside, and the cone reaches no further than
  /// kMaxAspectRatio, 1e4, times its inscribed radius.
  Cone(double height, double radius, double base);
  /// Returns the cone whose origin is the centre of mass of the cone with a ball of radius `rounding` swept over it.
  static Cone in_principal_frame(double height, double radius, double rounding);

  double height() const { return height_; }  ///< distance of the apex from the base
  double radius() const { return radius_; }  ///< radius of the base
  double base() const { return base_; }      ///< z of the base, body frame; the apex is at base + height

  std::optional<int> symmetry_axis() const { return 2; }  ///< axis of revolution: z
  bool centrally_symmetric() const { return false; }      ///< whether -x is in the body for every x in it
  /// Returns the cone of `factor` times the size. Throws as the constructors do.
  Cone scaled(double factor) const { return {factor * height_, factor * radius_, factor * base_}; }
  /// Returns "cone of height 2 and radius 0.5", for messages.
  std::string description() const;

  /// Returns whether a point is in the cone or on its surface.
  bool contains(const Eigen::Vector3d& x) const { return kernel::frustum_contains(core(), x); }

  /// Returns h(n), the larger of the heights of apex and rim, and the apex, a point of the rim, or the middle of the
  /// base if n is along -z; n as of SupportShape.
  Support support(const Eigen::Vector3d& n) const { return kernel::core_support(core(), n); }
  /// Returns hess h away from its kinks: that of the rim, or zero.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const { return kernel::rim_hessian(core(), n); }

  double bounding_radius() const { return bounding_radius_; }    ///< distance of the apex or the rim from the origin
  double inscribed_radius() const { return inscribed_radius_; }  ///< distance of the surface from the origin
  double min_curvature_radius() const { return 0; }              ///< 0: apex and rim are sharp
  double volume() const;                                         ///< pi radius^2 height / 3
  /// Returns the centre of mass, body frame.
  Eigen::Vector3d centre_of_mass() const { return {0, 0, base_ + 0.25 * height_}; }
  /// Returns whether the centre of mass is the origin, to 1e-9 of the size.
  bool is_in_principal_frame() const;
  /// Returns the principal moments of inertia about body x, y, z through the origin at uniform density.
  Eigen::Vector3d inertia(double mass) const;

  /// Returns the cone as a core.
  kernel::CoreView core() const {
    return {.kind = kernel::CoreKind::frustum,
            .disc = {{{base_, radius_}, {base_ + height_, 0}}},
            .bounding_radius = bounding_radius_};
  }

 private:
  double height_;
  double radius_;
  double base_;
  double bounding_radius_;
  double inscribed_radius_;
};

}  // namespace geom
