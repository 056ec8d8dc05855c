#pragma once

/// Displacements by direction: along and across the director, and along the edges of the box.

#include "base/archive.h"

#include <ed/snapshot.h>

#include <Eigen/Core>

#include <cstddef>

namespace ed::internal {

/// Sums of squares and fourth powers of displacements by direction. The square across the director is the whole one
/// without `along2`.
struct DirectedSums {
  double along2 = 0;                                ///< (dr.n)^2, n the director of the earlier frame
  double along4 = 0;                                ///< (dr.n)^4
  double across4 = 0;                               ///< |dr - (dr.n) n|^4
  Eigen::Vector3d edge2 = Eigen::Vector3d::Zero();  ///< squares of the components along the box's edges
  Eigen::Vector3d edge4 = Eigen::Vector3d::Zero();  ///< fourth powers of these

  /// Adds sums with a weight.
  void add(const DirectedSums& other, double weight);

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.along2, self.along4, self.across4, self.edge2, self.edge4);
  }
};

/// Returns the sums over bodies begin, begin + 1, .., end - 1 of two frames.
DirectedSums directed_sums(const Snapshot& a, const Snapshot& b, std::size_t begin, std::size_t end,
                           const Eigen::Vector3d& director);

}  // namespace ed::internal
