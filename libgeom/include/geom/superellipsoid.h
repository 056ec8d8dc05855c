#pragma once

#include <geom/export.h>
#include <geom/kernel/nested_norm.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <optional>
#include <string>

namespace geom {

/// Barr's superellipsoid {x : (|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1) <= 1} in the body's frame. Exponent
/// e < 1: flat faces and rounded edges (a box for e -> 0); e = 1: the ellipsoid; e > 1: edges (an octahedron for e =
/// 2). e1 shapes the profile along z, e2 the section across it.
class GEOM_EXPORT Superellipsoid {
 public:
  /// Constructs a superellipsoid from its semi-axes along body x, y, z and its exponents. Throws std::invalid_argument
  /// unless each semi-axis is within [kMinSemiAxis, kMaxSemiAxis], 1e-50 to 1e50, the largest at most kMaxAspectRatio,
  /// 1e4, times the smallest, and both exponents are within [kMinExponent, kMaxExponent], 0.2 to 1.6. Beyond an aspect
  /// ratio of 10 distances can be less accurate and slower (see distance.h).
  Superellipsoid(const Eigen::Vector3d& semi_axes, double e1, double e2);

  const Eigen::Vector3d& semi_axes() const { return semi_axes_; }  ///< semi-axes along body x, y, z
  double e1() const { return e1_; }                                ///< exponent of the profile along z
  double e2() const { return e2_; }                                ///< exponent of the section across z

  /// Returns N(x) = ((|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1))^(e1/2), the norm whose unit ball the body
  /// is: x/N(x) is on the surface.
  double norm(const Eigen::Vector3d& x) const;
  /// Returns f(x) = N(x)^2 - 1: negative inside. For e1 = e2 = 1 this function and the following ones give the same
  /// bits as Ellipsoid.
  double value(const Eigen::Vector3d& x) const;
  Eigen::Vector3d gradient(const Eigen::Vector3d& x) const;  ///< gradient of f; zero in the centre
  /// Returns the Hessian of f; x != 0 (NaN at 0 unless e1 = e2 = 1). In the planes x = 0, y = 0, z = 0, where second
  /// derivatives are infinite for e > 1, the Hessian of a point nearby is returned, which is huge.
  Eigen::Matrix3d hessian(const Eigen::Vector3d& x) const;

  /// Returns h(n) = N*(a n_x, b n_y, c n_z) and its gradient, with N* the dual norm, exponents 2/(2 - e); n != 0, any
  /// length.
  Support support(const Eigen::Vector3d& n) const;
  /// Returns hess h, a sum of two rank-one matrices across n. Huge if n is along a flat face's normal.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const;

  /// Returns the index (0, 1, 2) of an axis of revolution (2 if all axes are), else nullopt.
  std::optional<int> symmetry_axis() const;
  /// Returns whether the second derivatives of f are unbounded on the surface: some exponent is above 1.
  bool has_vertices() const { return e1_ > 1 || e2_ > 1; }
  /// Returns the superellipsoid of `factor` times the size. Throws as the constructor does.
  Superellipsoid scaled(double factor) const { return {factor * semi_axes_, e1_, e2_}; }
  /// Returns "superellipsoid of semi-axes 1 x 1 x 3, exponents 0.5, 0.5", for messages.
  std::string description() const;

  bool is_ellipsoid() const { return e1_ == 1 && e2_ == 1; }     ///< whether both exponents are 1
  double bounding_radius() const { return bounding_radius_; }    ///< largest distance of the surface from the centre
  double inscribed_radius() const { return inscribed_radius_; }  ///< smallest distance of the surface from the centre
  /// Returns a lower bound of the smallest radius of curvature, 0 if an exponent is above 1: edges and vertices have
  /// none. For e1 = e2 = e it is e / (2 - e) a (a / R)^(e / (2 - e)) 2^((1 - e) / (2 - e)), with a the smallest
  /// semi-axis and R the bounding radius: exact for ellipsoids, at least 0.95 of the smallest radius for superballs,
  /// about two thirds for semi-axes 1, 2, 3. The general formula and its proof are in superellipsoid.cpp.
  double min_curvature_radius() const { return min_curvature_radius_; }
  /// Returns the volume, by Beta functions (Jaklic, Leonardis and Solina, Segmentation and Recovery of Superquadrics
  /// (2000), sec. 2.5), with a relative error of at most 1e-12.
  double volume() const;
  /// Returns the principal moments about body x, y, z at uniform density, in units of mass times length^2; same source
  /// and accuracy as the volume.
  Eigen::Vector3d inertia(double mass) const;

 private:
  Eigen::Vector3d semi_axes_;
  double e1_;
  double e2_;
  kernel::NestedNorm norm_;  ///< norm of x/a: the body is its unit ball
  kernel::NestedNorm dual_;  ///< norm of a n: the support function
  double bounding_radius_;
  double inscribed_radius_;
  double min_curvature_radius_;
};

}  // namespace geom
