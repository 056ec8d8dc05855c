#pragma once

#include <geom/export.h>
#include <geom/pose.h>
#include <geom/shape.h>

#include <Eigen/Core>

namespace geom {

/// Box of any orientation, {centre + axes x : |x_k| <= half_extents_k}. World frame.
struct OrientedBox {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< orthonormal columns
  Eigen::Vector3d half_extents = Eigen::Vector3d::Zero();
};

/// Returns the smallest box along the body's own axes that contains the body at X_WB (the paper's oriented bounding
/// parallelepiped): half extents (h(e_k) + h(-e_k)) / 2.
template <SupportShape Shape>
OrientedBox oriented_box(const Shape& shape, const Pose& X_WB) {
  OrientedBox box;
  box.axes = X_WB.rotation();
  Eigen::Vector3d middle;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d e = Eigen::Vector3d::Unit(k);
    const double high = Support(shape.support(e)).height;
    const double low = Support(shape.support(-e)).height;
    box.half_extents[k] = 0.5 * (high + low);
    middle[k] = 0.5 * (high - low);
  }
  box.centre = X_WB.position() + box.axes * middle;
  return box;
}

/// Returns whether two boxes overlap, by the separating-axis test with the 3 + 3 face normals and the 9 products of
/// edges (Gottschalk, Lin and Manocha, SIGGRAPH 1996). False is certain; true may be returned for boxes that are apart
/// by less than 1e-12 of their sizes. Never throws, never allocates.
GEOM_EXPORT bool boxes_meet(const OrientedBox& a, const OrientedBox& b);

}  // namespace geom
