#pragma once

#include <geom/export.h>
#include <geom/kernel/core.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <optional>
#include <string>

namespace geom {

/// Box {x : |x_k| <= half_extents_k} in the body's frame, with sharp edges.
class GEOM_EXPORT Box {
 public:
  /// Constructs a box from half its edges along body x, y, z. Throws std::invalid_argument unless each is within
  /// [kMinSemiAxis, kMaxSemiAxis], 1e-50 to 1e50, and the largest is at most kMaxAspectRatio, 1e4, times the smallest.
  explicit Box(const Eigen::Vector3d& half_extents);

  const Eigen::Vector3d& half_extents() const { return half_extents_; }  ///< half the edges along body x, y, z

  std::optional<int> symmetry_axis() const { return std::nullopt; }  ///< axis of revolution: none
  /// Returns the box of `factor` times the size. Throws as the constructor does.
  Box scaled(double factor) const { return Box(factor * half_extents_); }
  /// Returns "box of half extents 1 x 2 x 3", for messages.
  std::string description() const;

  /// Returns whether a point is in the box or on its surface.
  bool contains(const Eigen::Vector3d& x) const { return (x.cwiseAbs().array() <= half_extents_.array()).all(); }

  /// Returns h(n) = sum of half_extents_k |n_k| and a vertex; n != 0, any length.
  Support support(const Eigen::Vector3d& n) const { return kernel::core_support(core(), n); }
  /// Returns zero, the Hessian wherever no n_k is 0.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& /*n*/) const { return Eigen::Matrix3d::Zero(); }

  double bounding_radius() const { return bounding_radius_; }           ///< half the diagonal
  double inscribed_radius() const { return half_extents_.minCoeff(); }  ///< the smallest half extent
  double min_curvature_radius() const { return 0; }                     ///< 0: edges are sharp
  double volume() const { return 8 * half_extents_.prod(); }            ///< product of the edges
  /// Returns the principal moments of inertia about body x, y, z at uniform density: m (b^2 + c^2) / 3, ...
  Eigen::Vector3d inertia(double mass) const;

  /// Returns the box as a core.
  kernel::CoreView core() const {
    return {.kind = kernel::CoreKind::box, .half = half_extents_, .bounding_radius = bounding_radius_};
  }

 private:
  Eigen::Vector3d half_extents_;
  double bounding_radius_;
};

}  // namespace geom
