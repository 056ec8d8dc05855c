/// Hulls of ConvexPolyhedron against CGAL's: the same number of extreme points and the same volume, for points on
/// grids, where many are coplanar or collinear, too.

#include "common/geom/random.h"
#include "oracle/cgal_hull.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;
using geom_test::repetitions;

std::vector<Vector3d> drawn_points(int kind, Random& random) {
  std::vector<Vector3d> points;
  const int count = 8 + static_cast<int>(60 * random.uniform());
  for (int k = 0; k < count; ++k) {
    const Vector3d x(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const auto on_grid = [&](double cell) { return Vector3d(((x / cell).array().round() * cell).matrix()); };
    switch (kind) {
      case 0:
        points.push_back(x);
        break;
      case 1:
        points.push_back(on_grid(0.5));
        break;
      case 2:
        points.push_back(on_grid(0.1));  // nearly coplanar: tenths are rounded
        break;
      default:
        points.push_back(x.normalized());
    }
  }
  return points;
}

TEST(Hull, OfPointsIsThatOfCgal) {
  Random random(1);
  int compared = 0;
  for (int i = 0; i < repetitions(2000); ++i) {
    const std::vector<Vector3d> points = drawn_points(i % 4, random);
    try {
      const ConvexPolyhedron ours(points);
      const geom_test::CgalHull theirs = geom_test::cgal_hull(points);
      ASSERT_EQ(ours.vertex_count(), theirs.vertices) << i;
      ASSERT_NEAR(ours.volume(), theirs.volume, 1e-13) << i;
      ++compared;
    } catch (const std::invalid_argument&) {
      continue;  // the origin may be outside
    }
  }
  EXPECT_GT(compared, repetitions(1500));
}

}  // namespace
}  // namespace geom
