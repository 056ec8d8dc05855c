#pragma once

/// Closest points of two bodies as a stationary point: the normal and the points of two features, and the linear system
/// of Newton's step there.

#include "derivatives/feature.h"

#include <geom/derivatives.h>
#include <geom/distance.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace geom::kernel {

/// Witness points relative to the centres of their bodies.
struct ContactPoints {
  Eigen::Vector3d a, b;
};

/// Solves W x = y for a symmetric positive definite W, the larger pivot first: right to rounding in each component
/// where one of W's diagonal elements is much larger than the other.
template <int Columns>
Eigen::Matrix<double, 2, Columns> solve_definite(const Eigen::Matrix2d& W, const Eigen::Matrix<double, 2, Columns>& y) {
  const int i = W(0, 0) >= W(1, 1) ? 0 : 1;
  const int j = 1 - i;
  const double factor = W(0, 1) / W(i, i);
  Eigen::Matrix<double, 2, Columns> x;
  x.row(j) = (y.row(j) - factor * y.row(i)) / (W(j, j) - factor * W(0, 1));
  x.row(i) = (y.row(i) - W(0, 1) * x.row(j)) / W(i, i);
  return x;
}

/// Two features at their closest points: r + x_B - x_A = distance n, r from A's centre to B's. Matrices of two rows are
/// in the plane across n.
struct StationaryPair {
  Eigen::Vector3d n = Eigen::Vector3d::UnitX();
  Eigen::Vector3d e = Eigen::Vector3d::UnitY(), f = Eigen::Vector3d::UnitZ();  ///< basis of the plane
  double distance = 0;
  LocalContact a, b;
  Eigen::Matrix2d H_a, H_b;                     ///< derivative of the points by the bodies' own outward normals
  Eigen::Matrix2d W;                            ///< H_a + H_b + distance
  std::size_t count = 0;                        ///< number of free directions of both bodies, at most 2
  std::array<std::size_t, 2> owner = {};        ///< body of each free direction: 0: A, 1: B
  Eigen::Matrix2d G = Eigen::Matrix2d::Zero();  ///< columns: free directions, A's first
  double stiffness = 0;                         ///< least eigenvalue of W where the normal is free
  bool curved = true;                           ///< whether both Hessians are finite

  Eigen::Matrix<double, 3, 2> tangent() const { return (Eigen::Matrix<double, 3, 2>() << e, f).finished(); }

  /// Returns whether the body that fixes the normal more is A: that with more free directions, else the flatter one.
  bool first_is_a() const {
    if (a.count != b.count) return a.count > b.count;
    return H_a.squaredNorm() >= H_b.squaredNorm();
  }

  /// Returns w of the system W w + (slides) = y, G'w = c.
  template <int Columns>
  Eigen::Matrix<double, 2, Columns> turn(const Eigen::Matrix<double, 2, Columns>& y,
                                         const Eigen::Matrix<double, 2, Columns>& c) const {
    if (count == 0) return solve_definite<Columns>(W, y);
    if (count == 2) return G.transpose().inverse() * c;
    const Eigen::Vector2d g = G.col(0);
    const Eigen::Vector2d across(-g.y(), g.x());
    const Eigen::Matrix<double, 2, Columns> along = g / g.squaredNorm() * c.row(0);
    return along + across * (across.transpose() * (y - W * along)) / across.dot(W * across);
  }
};

/// Returns the stationary point that an answer is near to; nullopt if the features are not certain, are parallel, or
/// have none near the answer.
std::optional<StationaryPair> stationary_pair(const ContactBody& a, const ContactBody& b, const DistanceResult& at,
                                              const ContactPoints& points);

/// Returns whether the closest points of bodies apart are the only ones, from the directions in which they are free.
bool points_are_single(const ContactBody& a, const ContactBody& b, const Eigen::Vector3d& n,
                       const ContactPoints& points, double size);

}  // namespace geom::kernel
