#pragma once

/// Volume and moments of bodies that have no closed form for them.

#include <geom/shape.h>

#include <Eigen/Core>

namespace geom {

/// At density 1, in the body's frame, about the origin.
struct MassProperties {
  double volume = 0;
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();  ///< integral of x: volume times the centre of mass
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();       ///< integral of |x|^2 I - x x^T
  double relative_error = 0;                               ///< estimated, of volume and inertia
};

/// By quadrature over the directions n from the origin, r(n) the surface: volume = integral of r^3 / 3, second moments
/// that of n n^T r^5 / 5. Any convex body {f <= 0} with the origin inside, f convex. Units: length^3 of the volume, ^4
/// of the first moment, ^5 of the inertia. `bounding_radius`, positive and finite, is at least the largest distance of
/// the surface from the origin: Newton's method starts there, outside, where it is monotone. Neither that nor convexity
/// is checked.
///
/// Tanh-sinh rule in both angles of each octant (Takahasi and Mori, Publ. RIMS 9 (1974) 721), which does not mind that
/// derivatives are singular in the planes between octants, as those of superquadrics are. The rule is doubled until two
/// results agree within `tolerance`, relative, or 641 nodes an angle are used (boxes with sharp edges, some seconds);
/// `relative_error` is their difference, mostly far above the error of the last one.
template <ImplicitSurface Shape>
MassProperties mass_properties(const Shape& shape, double bounding_radius, double tolerance = 1e-9);

}  // namespace geom

#include <geom/kernel/mass_impl.h>
