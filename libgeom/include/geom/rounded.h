#pragma once

#include <geom/distance.h>
#include <geom/kernel/core.h>
#include <geom/pose.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <optional>
#include <sstream>
#include <string>
#include <utility>

namespace geom {
/// Minkowski sum of a shape with a ball: all points within `radius` of it. Its distances are those of the shape inside,
/// less the radius; overlaps no deeper than the radii are as fast as bodies apart.
template <SupportShape Inner>
class Rounded {
 public:
  /// Throws std::invalid_argument unless the radius is within [0, kMaxSemiAxis].
  Rounded(Inner inner, double radius) : inner_(std::move(inner)), radius_(kernel::checked_rounding(radius)) {}

  const Inner& inner() const { return inner_; }  ///< shape that is rounded
  double radius() const { return radius_; }      ///< radius of the ball

  /// Returns the axis of revolution of the shape inside.
  std::optional<int> symmetry_axis() const requires requires(const Inner& s) { s.symmetry_axis(); }
  { return inner_.symmetry_axis(); }
  /// Returns whether -x is in the body for every x in it.
  bool centrally_symmetric() const requires requires(const Inner& s) { s.centrally_symmetric(); }
  { return inner_.centrally_symmetric(); }
  /// Returns the shape of `factor` times the size. Throws as the constructors do.
  Rounded scaled(double factor) const requires requires(const Inner& s) { s.scaled(1.0); }
  { return {inner_.scaled(factor), factor * radius_}; }
  /// Returns "box of half extents 1 x 2 x 3, rounded by 0.2", for messages.
  std::string description() const requires requires(const Inner& s) { s.description(); }
  {
    std::ostringstream text;
    text << inner_.description() << ", rounded by " << radius_;
    return text.str();
  }

  /// Returns h(n) + radius |n| and the support point; n as of SupportShape.
  Support support(const Eigen::Vector3d& n) const {
    Support s = inner_.support(n);
    const double length = n.norm();
    s.height += radius_ * length;
    s.point += radius_ / length * n;
    return s;
  }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const {  ///< sum of both Hessians
    return inner_.support_hessian(n) + kernel::ball_hessian(radius_, n);
  }

  /// Returns whether a point is in the body or on its surface, to the rounding of its distance from the shape inside.
  bool contains(const Eigen::Vector3d& x) const requires CoreShape<Inner> { return kernel::core_contains(core(), x); }

  double bounding_radius() const { return inner_.bounding_radius() + radius_; }    ///< sum of both
  double inscribed_radius() const { return inner_.inscribed_radius() + radius_; }  ///< sum of both
  /// Returns the sum of both smallest radii of curvature, at least `radius`.
  double min_curvature_radius() const { return kernel::min_curvature_radius_or_zero(inner_) + radius_; }

  /// Returns the volume, by Steiner's formula.
  double volume() const requires CoreShape<Inner> { return kernel::swept_mass(core()).volume; }
  /// Returns the centre of mass, body frame.
  Eigen::Vector3d centre_of_mass() const requires CoreShape<Inner> { return kernel::swept_mass(core()).centre(); }
  /// Returns the inertia tensor about the origin at uniform density.
  Eigen::Matrix3d inertia_tensor(double mass) const requires CoreShape<Inner> {
    return kernel::swept_mass(core()).inertia(mass);
  }
  /// Returns the diagonal of the inertia tensor: the principal moments if is_in_principal_frame().
  Eigen::Vector3d inertia(double mass) const requires CoreShape<Inner> { return inertia_tensor(mass).diagonal(); }
  /// Returns whether the body's frame is that of the principal axes, to 1e-9 of the size.
  bool is_in_principal_frame() const requires CoreShape<Inner> {
    return kernel::swept_mass(core()).is_principal(bounding_radius());
  }

  /// Returns the core of the shape that is rounded, with both balls.
  kernel::CoreView core() const requires CoreShape<Inner> {
    kernel::CoreView core = inner_.core();
    core.radius += radius_;
    return core;
  }

 private:
  Inner inner_;
  double radius_;
};

namespace kernel {
template <class Inner>
inline constexpr bool kIsRounded<Rounded<Inner>> = true;
}  // namespace kernel

}  // namespace geom
