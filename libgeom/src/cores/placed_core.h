#pragma once

/// A core in the world's directions, as the set of vertices that the polytope methods need.

#include <geom/kernel/core.h>
#include <geom/kernel/core_simplex.h>

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>

namespace geom::kernel {

/// Vertex of a core, and a number that tells it from the core's others.
struct CoreVertex {
  Eigen::Vector3d x;
  int id;
};

/// Core turned by R and moved by t. Points, segments and boxes are sums of 0, 1 or 3 segments, the generators.
class PlacedCore {
 public:
  PlacedCore(const CoreView& core, const Eigen::Matrix3d& R, const Eigen::Vector3d& t) : core_(core), R_(R), t_(t) {
    if (core.kind == CoreKind::segment) generator_[count_++] = core.half.z() * R.col(2);
    if (core.kind == CoreKind::box) {
      for (int k = 0; k < 3; ++k) generator_[count_++] = core.half[k] * R.col(k);
    }
  }

  /// Returns the vertex furthest along n. One vertex always has the same coordinates.
  CoreVertex vertex(const Eigen::Vector3d& n) const {
    if (core_.hull != nullptr) {
      const int k = support_vertex(*core_.hull, R_.transpose() * n);
      return {t_ + R_ * core_.hull->vertices.row(k).transpose(), k};
    }
    CoreVertex v{t_, 0};
    for (std::size_t k = 0; k < count_; ++k) {
      const bool down = std::signbit(n.dot(generator_[k]));
      v.x += down ? Eigen::Vector3d(-generator_[k]) : generator_[k];
      v.id = 2 * v.id + (down ? 1 : 0);
    }
    return v;
  }

  std::size_t generators() const { return count_; }                          ///< 0, 1 or 3
  Eigen::Vector3d generator(std::size_t k) const { return generator_[k]; }   ///< half an edge
  const Hull* hull() const { return core_.hull; }                            ///< null unless a hull
  Eigen::Vector3d turned(const Eigen::Vector3d& v) const { return R_ * v; }  ///< direction in the world
  Eigen::Vector3d point(int k) const {
    return t_ + R_ * core_.hull->vertices.row(k).transpose();
  }                                                                                   ///< vertex of a hull
  const Eigen::Vector3d& centre() const { return t_; }                                ///< the core's origin
  PlacedCore moved(const Eigen::Vector3d& by) const { return {core_, R_, t_ + by}; }  ///< translated copy

 private:
  const CoreView& core_;
  const Eigen::Matrix3d& R_;
  Eigen::Vector3d t_;
  std::array<Eigen::Vector3d, 3> generator_;
  std::size_t count_ = 0;
};

/// Returns the point of B - A that is nearest along n: n.p is the gap between the tangent planes.
template <class Placed>
DifferenceVertex difference_vertex(const Placed& a, const Placed& b, const Eigen::Vector3d& n) {
  const CoreVertex va = a.vertex(n);
  const CoreVertex vb = b.vertex(-n);
  return {vb.x - va.x, va.x, vb.x, va.id, vb.id};
}

}  // namespace geom::kernel
