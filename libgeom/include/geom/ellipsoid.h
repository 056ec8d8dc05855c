#pragma once

#include <geom/export.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <optional>
#include <string>

namespace geom {

/// Ellipsoid {x : (x/a)^2 + (y/b)^2 + (z/c)^2 <= 1} in the body's frame.
class GEOM_EXPORT Ellipsoid {
 public:
  /// Constructs an ellipsoid from its semi-axes along body x, y, z. Throws std::invalid_argument unless each is within
  /// [kMinSemiAxis, kMaxSemiAxis], 1e-50 to 1e50, and the largest is at most kMaxAspectRatio, 1e4, times the smallest.
  /// Every accepted ellipsoid is answered within the contract of distance.h, beside bodies of any size.
  explicit Ellipsoid(const Eigen::Vector3d& semi_axes);

  const Eigen::Vector3d& semi_axes() const { return semi_axes_; }  ///< semi-axes along body x, y, z

  /// Returns the index (0, 1, 2) of the axis of revolution if two semi-axes are equal (2 for a sphere), else nullopt.
  std::optional<int> symmetry_axis() const {
    return symmetry_axis_ < 0 ? std::nullopt : std::optional<int>(symmetry_axis_);
  }

  bool has_vertices() const { return false; }  ///< whether the second derivatives of f are unbounded on the surface
  /// Returns the ellipsoid of `factor` times the size. Throws as the constructor does.
  Ellipsoid scaled(double factor) const { return Ellipsoid(factor * semi_axes_); }
  /// Returns "ellipsoid of semi-axes 1 x 1 x 3", for messages.
  std::string description() const;

  /// Returns f(x) = (x/a)^2 + (y/b)^2 + (z/c)^2 - 1 (the paper's eq. Shapes): negative inside.
  double value(const Eigen::Vector3d& x) const;
  Eigen::Vector3d gradient(const Eigen::Vector3d& x) const;  ///< gradient of f
  Eigen::Matrix3d hessian(const Eigen::Vector3d& x) const;   ///< Hessian of f

  /// Returns h(n) = |D n| and s(n) = D^2 n / h with D = diag(a, b, c).
  Support support(const Eigen::Vector3d& n) const;
  /// Returns hess h = (D^2 - s s^T) / h. For |n| = 1 its eigenvalues across n are the principal radii of curvature at
  /// s.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const;

  double bounding_radius() const { return bounding_radius_; }    ///< the largest semi-axis
  double inscribed_radius() const { return inscribed_radius_; }  ///< the smallest semi-axis
  /// Returns the smallest principal radius of curvature of the surface, amin^2 / amax.
  double min_curvature_radius() const { return min_curvature_radius_; }
  double volume() const;  ///< 4 pi a b c / 3
  /// Returns the principal moments of inertia about body x, y, z at uniform density: m (b^2 + c^2) / 5, ...
  Eigen::Vector3d inertia(double mass) const;

 private:
  Eigen::Vector3d semi_axes_;
  double bounding_radius_;
  double inscribed_radius_;
  double min_curvature_radius_;
  int symmetry_axis_;
};

}  // namespace geom
