#pragma once

/// @file
/// Test of a user's own support function.

#include <geom/export.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <functional>
#include <string>

namespace geom {

namespace kernel {

/// SupportShape without its type.
struct SupportFunctions {
  std::function<Support(const Eigen::Vector3d&)> support;
  std::function<Eigen::Matrix3d(const Eigen::Vector3d&)> hessian;
  double bounding_radius;
  double inscribed_radius;
  double min_curvature_radius;
};

GEOM_EXPORT std::string support_fault(const SupportFunctions& shape);

}  // namespace kernel

/// Samples a shape's support function and returns the first fault found, in words; empty if there is none. Sampled, in
/// 278 directions of several lengths: h and s are finite; h(n) = n.s(n); h is 1-homogeneous; the body is convex, no
/// support point beyond the plane of another one; the radii are in order and those of spheres about the origin outside
/// and inside; the Hessian is symmetric, has no negative eigenvalue, vanishes along n, and is the derivative of s
/// wherever s is smooth; it is never below `min_curvature_radius()`, if the shape has that. Lengths are compared to
/// 1e-9 of the bounding radius, the Hessian to 1e-3 of it. Takes about a millisecond: for tests and constructors.
///
/// Finding none is no proof, but each of these faults makes answers of `distance` wrong without notice.
template <SupportShape Shape>
std::string check_support(const Shape& shape) {
  kernel::SupportFunctions functions{
      [&](const Eigen::Vector3d& n) { return Support(shape.support(n)); },
      [&](const Eigen::Vector3d& n) { return Eigen::Matrix3d(shape.support_hessian(n)); }, shape.bounding_radius(),
      shape.inscribed_radius(), 0};
  if constexpr (requires { shape.min_curvature_radius(); }) {
    functions.min_curvature_radius = shape.min_curvature_radius();
  }
  return kernel::support_fault(functions);
}

}  // namespace geom
