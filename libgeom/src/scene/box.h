#pragma once

/// Boxes along the axes of the world.

#include <Eigen/Core>

#include <limits>

namespace geom::scene {

/// Box {x : low <= x <= high}; empty as it is constructed.
struct Box3 {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());

  bool empty() const { return low.x() > high.x(); }
  Eigen::Vector3d centre() const { return 0.5 * (low + high); }

  /// Returns half the area of the surface, 0 of an empty box.
  double half_area() const {
    if (empty()) return 0;
    const Eigen::Vector3d w = high - low;
    return w.x() * w.y() + w.y() * w.z() + w.z() * w.x();
  }

  bool contains(const Box3& other) const {
    return (low.array() <= other.low.array()).all() && (high.array() >= other.high.array()).all();
  }

  void add(const Box3& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }

  Box3 moved(const Eigen::Vector3d& by) const { return {low + by, high + by}; }
  Box3 grown(double by) const { return {low - Eigen::Vector3d::Constant(by), high + Eigen::Vector3d::Constant(by)}; }
};

/// Returns a lower bound of the signed distance of any bodies within the boxes: the distance of the boxes, or minus the
/// shortest translation along an axis that separates them.
inline double signed_distance(const Box3& a, const Box3& b) {
  const Eigen::Vector3d gap = (a.low - b.high).cwiseMax(b.low - a.high);
  const double widest = gap.maxCoeff();
  return widest <= 0 ? widest : gap.cwiseMax(0).norm();
}

}  // namespace geom::scene
