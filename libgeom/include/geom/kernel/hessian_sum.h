#pragma once

/// Sum S of the Hessians of both bodies' support functions across a normal, each t1 t1^T + t2 t2^T.

#include <geom/kernel/lanes.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace geom::kernel {

/// Determinant and adjugate of S. With t_k the four vectors and p_k = n x t_k: det S = sum over k < l of (p_k.t_l)^2,
/// all terms positive, so that nothing cancels if one body is flat and the other is not; the smallest eigenvalue is det
/// S over the largest.
struct HessianSum {
  LaneVector p1, p2;  ///< n x t1, n x t2
  Lanes within;       ///< p1.t2 of each body; the next members: of A with B's and of B with A's
  Lanes across11, across12, across22;
  double determinant;
  double trace;

  HessianSum(const Eigen::Vector3d& normal, const LaneVector& t1, const LaneVector& t2) {
    const LaneVector n = LaneVector::same(normal);
    p1 = n.cross(t1);
    p2 = n.cross(t2);
    within = p1.dot(t2);
    across11 = p1.dot(swapped(t1));
    across12 = p1.dot(swapped(t2));
    across22 = p2.dot(swapped(t2));
    determinant = sum(within * within + across12 * across12) + across11[0] * across11[0] + across22[0] * across22[0];
    trace = sum(p1.dot(p1) + p2.dot(p2));
  }

  double smallest() const {
    const double largest = 0.5 * trace + std::sqrt(std::max(0.0, 0.25 * trace * trace - determinant));
    return largest > 0 ? determinant / largest : 0;
  }
  /// Returns 1 / det(S + identity I); for two points without a gap at most the largest number.
  double by_determinant(double identity) const {
    return 1 / (identity * (identity + trace) + determinant + std::numeric_limits<double>::min());
  }
  /// Returns the adjugate of S + identity I times y, which is across n.
  Eigen::Vector3d adjugate_times(const Eigen::Vector3d& y, double identity) const {
    const LaneVector up = p1.dot(y) * p1 + p2.dot(y) * p2;
    return identity * y + up.a() + up.b();
  }
};

}  // namespace geom::kernel
