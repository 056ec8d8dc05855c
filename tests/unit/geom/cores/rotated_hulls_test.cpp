/// ConvexPolyhedron of turned points: those of one face or edge are in a plane or line to rounding only, so that the
/// exact hull has faces that are as thin as rounding.

#include "common/geom/random.h"
#include "common/message_of.h"

#include <geom/geom.h>
#include <geom/polyhedron.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;
using geom_test::repetitions;
using test_common::message_of;

using Points = std::vector<Vector3d>;

/// Returns the points of a grid of count^3 that are on the surface of the cube |x|, |y|, |z| <= 1.
Points grid_surface(int count) {
  Points points;
  const auto place = [count](int k) { return 2.0 * k / (count - 1) - 1; };
  for (int i = 0; i < count * count * count; ++i) {
    const Vector3d x(place(i % count), place(i / count % count), place(i / (count * count)));
    if (x.cwiseAbs().maxCoeff() == 1) points.push_back(x);
  }
  return points;
}

Points turned(const Points& points, const Matrix3d& R) {
  Points result;
  for (const Vector3d& x : points) result.emplace_back(R * x);
  return result;
}

/// Returns the points and those that divide each edge of their hull into `parts`.
Points with_points_of_edges(Points points, int parts) {
  const ConvexPolyhedron hull(points);
  for (const kernel::HullEdge& edge : hull.core().hull->edges) {
    const Vector3d from = hull.vertex(edge.from);
    for (int k = 1; k < parts; ++k) points.emplace_back(from + 1.0 * k / parts * (hull.vertex(edge.to) - from));
  }
  return points;
}

/// Checks that the planes of the faces are those of the hull: unit normals outwards, every point below, corners on
/// them.
void check_planes(const ConvexPolyhedron& p, const Points& points) {
  const double rounding = 4e-15 * p.bounding_radius();
  ASSERT_EQ(p.vertex_count() - p.edge_count() + static_cast<int>(p.faces().size()), 2);
  const kernel::Hull& hull = *p.core().hull;
  for (std::size_t f = 0; f < hull.normals.size(); ++f) {
    ASSERT_NEAR(hull.normals[f].norm(), 1, 1e-15);
    ASSERT_GT(hull.offsets[f], 0);
    for (const Vector3d& x : points) ASSERT_LE(hull.normals[f].dot(x) - hull.offsets[f], rounding);
    for (const int k : hull.faces[f]) ASSERT_NEAR(hull.normals[f].dot(p.vertex(k)), hull.offsets[f], rounding);
  }
}

/// Checks that a hull of turned points has the surface, volume and distances of that of the turned corners.
void check_hull(const Points& points, const Points& corners, Random& random) {
  const Matrix3d R = random.pose(0.0).rotation();
  const Points all = turned(points, R);
  const ConvexPolyhedron hull(all);
  check_planes(hull, all);
  if (testing::Test::HasFatalFailure()) return;
  const ConvexPolyhedron exact(turned(corners, R));
  const double size = 2 * exact.bounding_radius();
  EXPECT_NEAR(hull.inscribed_radius(), exact.inscribed_radius(), 1e-14 * size);
  EXPECT_NEAR(hull.volume(), exact.volume(), 1e-13 * exact.volume());
  EXPECT_EQ(merged_faces(hull).size(), merged_faces(exact).size());
  for (int k = 0; k < 4; ++k) {
    const Vector3d n = random.direction();
    double height = 0;
    for (const Vector3d& x : all) height = std::max(height, n.dot(x));
    EXPECT_EQ(hull.support(n).height, height);
    // In any orientation, and beside the same body turned the same way; apart and overlapping.
    const Pose X_WB = random.coin() ? random.pose(0.7 * size) : Pose::translation(0.5 * size * random.direction());
    const DistanceResult d = distance(exact, Pose(), exact, X_WB);
    for (const DistanceResult& other : {distance(hull, Pose(), exact, X_WB), distance(hull, Pose(), hull, X_WB)}) {
      EXPECT_NEAR(other.distance, d.distance, 1e-13 * (size + X_WB.position().norm()));
    }
    const Vector3d x = 0.6 * size * random.direction();
    EXPECT_NEAR(distance(hull, Pose(), Sphere(0.1), Pose::translation(x)).distance,
                distance(exact, Pose(), Sphere(0.1), Pose::translation(x)).distance, 1e-13 * size);
  }
}

TEST(RotatedHulls, OfPointsOfGridsAreThoseOfTheirCorners) {
  Random random(1);
  const Points corners = grid_surface(2);
  for (int i = 0; i < repetitions(200); ++i) {
    SCOPED_TRACE(i);
    check_hull(grid_surface(3), corners, random);
    if (i % 10 == 0) check_hull(grid_surface(5), corners, random);
    if (HasFatalFailure()) return;
  }
}

TEST(RotatedHulls, OfAPrismWithPointsOnItsLongEdges) {
  Random random(2);
  Points corners;
  for (int k = 0; k < 6; ++k) {
    const double angle = k * std::numbers::pi / 3;
    for (const double z : {-4.0, 4.0}) corners.emplace_back(std::cos(angle), std::sin(angle), z);
  }
  for (int i = 0; i < repetitions(50); ++i) {
    SCOPED_TRACE(i);
    check_hull(with_points_of_edges(corners, 2 + i % 7), corners, random);
    if (HasFatalFailure()) return;
  }
}

TEST(RotatedHulls, OfPlatonicSolidsWithPointsOnTheirEdges) {
  Random random(3);
  for (const char* name : {"tetrahedron", "cube", "octahedron", "dodecahedron", "icosahedron"}) {
    const Points corners = solid_vertices(name);
    for (int i = 0; i < repetitions(30); ++i) {
      SCOPED_TRACE(name + std::to_string(i));
      check_hull(with_points_of_edges(corners, 2 + i % 2), corners, random);
      if (HasFatalFailure()) return;
    }
  }
}

/// Checks that thin faces do not disturb the moments of a hull with a ball swept over it.
TEST(RotatedHulls, HaveThePrincipalFrameOfTheirCorners) {
  Random random(4);
  const Points corners = grid_surface(2);
  const Matrix3d stretched = Vector3d(1, 2, 3).asDiagonal();
  for (int i = 0; i < repetitions(50); ++i) {
    const Matrix3d R = random.pose(0.0).rotation() * stretched;
    const ConvexPolyhedron all = ConvexPolyhedron::in_principal_frame(turned(grid_surface(3), R), nullptr, 0.5);
    const ConvexPolyhedron exact = ConvexPolyhedron::in_principal_frame(turned(corners, R), nullptr, 0.5);
    EXPECT_LE((Rounded(all, 0.5).inertia(1) - Rounded(exact, 0.5).inertia(1)).norm(), 1e-12);
    EXPECT_NEAR(all.bounding_radius(), exact.bounding_radius(), 1e-13);
  }
}

/// Points without a volume are refused as such, however they are turned.
TEST(RotatedHulls, WithoutAVolumeAreRefused) {
  const auto message = [](const Points& points) { return message_of([&] { ConvexPolyhedron p(points); }); };
  const Points square = {{1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {-1, 1, 0}, {0, 0, 0}};
  EXPECT_NE(message(square).find("lie in a plane"), std::string::npos) << message(square);
  EXPECT_NE(message({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}).find("3 points"), std::string::npos);
  EXPECT_NE(message({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}}).find("lie in a plane"), std::string::npos);
}

}  // namespace
}  // namespace geom
