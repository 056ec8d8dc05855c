#pragma once

/// Convex hulls by CGAL, with exact predicates, for oracle tests.

#include <Eigen/Core>

#include <vector>

namespace geom_test {

struct CgalHull {
  int vertices = 0;  ///< extreme points
  double volume = 0;
};

/// Returns CGAL's convex hull of points.
CgalHull cgal_hull(const std::vector<Eigen::Vector3d>& points);

}  // namespace geom_test
