#pragma once

#include "cores/placed_core.h"

#include <Eigen/Core>

namespace geom::kernel {

/// Normal across which the gap between the tangent planes of two cores is largest, and that gap.
struct WidestGap {
  Eigen::Vector3d n = Eigen::Vector3d::UnitX();
  double gap = 0;
  int evaluations = 0;
};

/// Searches the faces of the Minkowski difference of two polytopes that overlap: faces of either, and pairs of edges.
/// The largest gap, at most 0, is minus the depth. At least one core is a box or a hull.
WidestGap widest_gap(const PlacedCore& a, const PlacedCore& b);

}  // namespace geom::kernel
