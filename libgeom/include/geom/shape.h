#pragma once

#include <geom/export.h>

#include <Eigen/Core>

#include <concepts>

namespace geom {

/// Support height and support point of a convex body in one direction.
struct Support {
  double height;          ///< h(n) = max over the body of n.x, the length scale of n included (h is 1-homogeneous)
  Eigen::Vector3d point;  ///< s(n) = grad h(n), the point where that maximum is reached
};

/// Convex body given by its support function, in its own frame, the origin in its interior.
///
/// `support(n)` and `support_hessian(n)` = hess h(n) take any n of a length from 1e-150 to 1e150. `bounding_radius()`
/// and `inscribed_radius()` are the radii of spheres about the origin that contain the body and are contained in it.
/// `distance` needs nothing else. A shape may also have `min_curvature_radius()`, a lower bound of its smallest
/// principal radius of curvature (0 without it): overlaps down to the sum of both bodies' values are answered by
/// Newton's method alone, exact to rounding and within microseconds; deeper ones need the search over all normals and
/// have its `error_bound` (see distance.h).
template <class T>
concept SupportShape = requires(const T& shape, const Eigen::Vector3d& n) {
  { shape.support(n) } -> std::convertible_to<Support>;
  { shape.support_hessian(n) } -> std::convertible_to<Eigen::Matrix3d>;
  { shape.bounding_radius() } -> std::convertible_to<double>;
  { shape.inscribed_radius() } -> std::convertible_to<double>;
};

/// Body given as {x : f(x) <= 0} with f smooth, in its own frame: the form that the paper's distance equations need.
template <class T>
concept ImplicitSurface = requires(const T& shape, const Eigen::Vector3d& x) {
  { shape.value(x) } -> std::convertible_to<double>;
  { shape.gradient(x) } -> std::convertible_to<Eigen::Vector3d>;
  { shape.hessian(x) } -> std::convertible_to<Eigen::Matrix3d>;
};

}  // namespace geom
