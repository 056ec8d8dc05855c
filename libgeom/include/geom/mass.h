#pragma once

/// @file
/// Volume and moments of bodies for which no closed form is known.

#include <geom/shape.h>

#include <Eigen/Core>

namespace geom {

/// Volume and moments at density 1, in the body's frame, about the origin.
struct MassProperties {
  double volume = 0;
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();  ///< integral of x: volume times the centre of mass
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();       ///< integral of |x|^2 I - x x^T
  double relative_error = 0;                               ///< estimated relative error of volume and inertia
};

/// Integrates over the directions n from the origin, with r(n) the surface: volume = integral of r^3 / 3, second
/// moments = integral of n n^T r^5 / 5. Valid for any convex body {f <= 0} with the origin inside and f convex. Units:
/// length^3 for the volume, ^4 for the first moment, ^5 for the inertia. `bounding_radius`, positive and finite, is at
/// least the largest distance of the surface from the origin: Newton's method starts there, outside, where it is
/// monotone. Neither this bound nor convexity is checked.
///
/// The quadrature is the tanh-sinh rule in both angles of each octant (Takahasi and Mori, Publ. RIMS 9 (1974) 721),
/// which tolerates derivatives that are singular in the planes between octants, as those of superquadrics are. The rule
/// is doubled until two results agree within `tolerance`, relative, or 641 nodes an angle are used (boxes with sharp
/// edges, some seconds). `relative_error` is the difference of the last two results, mostly far above the error of the
/// last one.
template <ImplicitSurface Shape>
MassProperties mass_properties(const Shape& shape, double bounding_radius, double tolerance = 1e-9);

}  // namespace geom

#include <geom/kernel/mass_impl.h>
