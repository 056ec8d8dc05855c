/// Platonic and Archimedean solids: their numbers of vertices, edges and faces, edges of one length, one circumradius.
/// Faces that are in a plane to rounding.

#include "common/geom/random.h"
#include "common/message_of.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using test_common::message_of;

/// Name of a solid, numbers of its vertices, edges and faces, and its volume for edges of length 1.
struct SolidNumbers {
  std::string_view name;
  int vertices, edges, faces;
  double volume;
};

constexpr SolidNumbers kKnown[] = {
    {"tetrahedron", 4, 6, 4, 0.11785113019775792},
    {"cube", 8, 12, 6, 1},
    {"octahedron", 6, 12, 8, 0.47140452079103168},
    {"dodecahedron", 20, 30, 12, 7.6631189606246320},
    {"icosahedron", 12, 30, 20, 2.1816949906249124},
    {"truncated tetrahedron", 12, 18, 8, 2.7105759945484321},
    {"cuboctahedron", 12, 24, 14, 2.3570226039551584},
    {"truncated cube", 24, 36, 14, 13.599663291074443},
    {"truncated octahedron", 24, 36, 14, 11.313708498984761},
    {"rhombicuboctahedron", 24, 48, 26, 8.7140452079103168},
    {"truncated cuboctahedron", 48, 72, 26, 41.798989873223332},
    {"snub cube", 24, 60, 38, 7.8894773999753902},
    {"icosidodecahedron", 30, 60, 32, 13.835525936249404},
    {"truncated dodecahedron", 60, 90, 32, 85.039664559371116},
    {"truncated icosahedron", 60, 90, 32, 55.287730758122739},
    {"rhombicosidodecahedron", 60, 120, 62, 41.615323782497967},
    {"truncated icosidodecahedron", 120, 180, 62, 206.80339887498948},
    {"snub dodecahedron", 60, 150, 92, 37.616649962733362},
};

/// Returns the number of different normals of a hull: faces whose corners are in a plane to rounding may be triangles.
int count_planes(const kernel::Hull& hull, std::vector<std::size_t>& plane) {
  std::vector<Vector3d> normals;
  for (const Vector3d& n : hull.normals) {
    const auto same = [&](const Vector3d& m) { return (m - n).norm() < 1e-9; };
    const auto found = std::find_if(normals.begin(), normals.end(), same);
    plane.push_back(static_cast<std::size_t>(found - normals.begin()));
    if (found == normals.end()) normals.push_back(n);
  }
  return static_cast<int>(normals.size());
}

TEST(Solids, HaveTheirFeatures) {
  ASSERT_EQ(solid_names().size(), std::size(kKnown));
  for (std::size_t k = 0; k < std::size(kKnown); ++k) {
    const SolidNumbers& known = kKnown[k];
    EXPECT_EQ(solid_names()[k], known.name);
    const std::vector<Vector3d> points = solid_vertices(known.name);
    for (const Vector3d& x : points) ASSERT_NEAR(x.norm(), 1, 4e-16) << known.name;
    const ConvexPolyhedron solid(points);
    EXPECT_EQ(points.size(), static_cast<std::size_t>(known.vertices)) << known.name;
    EXPECT_EQ(solid.vertex_count(), known.vertices) << known.name;
    std::vector<std::size_t> plane;
    const kernel::Hull& hull = *solid.core().hull;
    EXPECT_EQ(count_planes(hull, plane), known.faces) << known.name;
    int edges = 0;
    double length = 0;
    for (const kernel::HullEdge& edge : hull.edges) {
      if (plane[static_cast<std::size_t>(edge.left)] == plane[static_cast<std::size_t>(edge.right)]) continue;
      const double of_edge = (hull.vertices.row(edge.to) - hull.vertices.row(edge.from)).norm();
      if (edges++ == 0) length = of_edge;
      ASSERT_NEAR(of_edge, length, 4e-15) << known.name;
    }
    EXPECT_EQ(edges, known.edges) << known.name;
    EXPECT_NEAR(solid.volume() / (length * length * length), known.volume, 2e-14 * known.volume) << known.name;
    EXPECT_TRUE(solid.is_in_principal_frame()) << known.name;
    const Vector3d inertia = solid.inertia(1);
    EXPECT_NEAR(inertia.maxCoeff(), inertia.minCoeff(), 1e-14) << known.name;
  }
}

/// Returns the number of edges of faces after checking that each edge has two faces, in opposite directions.
std::size_t count_edges(const std::vector<std::vector<int>>& faces) {
  std::set<std::pair<int, int>> edges;
  for (const std::vector<int>& face : faces) {
    for (std::size_t k = 0; k < face.size(); ++k) edges.insert({face[k], face[(k + 1) % face.size()]});
  }
  for (const auto& [from, to] : edges) EXPECT_TRUE(edges.contains({to, from}));
  return edges.size() / 2;
}

/// Returns the points turned and scaled.
std::vector<Vector3d> moved(const std::vector<Vector3d>& points, geom_test::Random& random) {
  const Eigen::Matrix3d R = random.pose(0.0).rotation();
  const double scale = std::exp(random.uniform(-20, 20));
  std::vector<Vector3d> result;
  for (const Vector3d& x : points) result.emplace_back(scale * (R * x));
  return result;
}

TEST(Solids, HaveTheirFacesInAnyOrientation) {
  geom_test::Random random(7);
  for (const SolidNumbers& known : kKnown) {
    for (int i = 0; i < 20; ++i) {
      const std::vector<Vector3d> points = solid_vertices(known.name);
      const ConvexPolyhedron solid(i == 0 ? points : moved(points, random));
      const std::vector<std::vector<int>> faces = merged_faces(solid);
      ASSERT_EQ(faces.size(), static_cast<std::size_t>(known.faces)) << known.name;
      ASSERT_EQ(count_edges(faces), static_cast<std::size_t>(known.edges)) << known.name;
      const std::string numbers = std::to_string(known.vertices) + " vertices and " + std::to_string(known.faces);
      ASSERT_EQ(solid.description(), "polyhedron of " + numbers + " faces");
    }
  }
}

TEST(MergedFaces, AreThoseOfTheHullUnlessInAPlane) {
  geom_test::Random random(8);
  for (int i = 0; i < 50; ++i) {
    std::vector<Vector3d> points;
    for (int k = 0; k < 40; ++k) points.push_back(random.direction());
    const ConvexPolyhedron hull(points);
    ASSERT_EQ(merged_faces(hull), hull.faces());
  }
}

/// Corners of a cube, and points on its surface that are outside by less than the tolerance.
std::vector<Vector3d> bumpy_cube(geom_test::Random& random) {
  std::vector<Vector3d> points;
  for (const double x : {-1.0, -0.25, 0.5, 1.0}) {
    for (const double y : {-1.0, 0.125, 1.0}) {
      for (const double z : {-1.0, -0.5, 0.75, 1.0}) {
        const Vector3d p(x, y, z);
        if (p.cwiseAbs().maxCoeff() < 1) continue;
        points.push_back(p.cwiseAbs().minCoeff() == 1 ? p : (1 + random.uniform(1e-14, 1e-13)) * p);
      }
    }
  }
  return points;
}

TEST(MergedFaces, LeaveOutVerticesWithinFacesAndEdges) {
  geom_test::Random random(9);
  for (int i = 0; i < 100; ++i) {
    const ConvexPolyhedron cube(moved(bumpy_cube(random), random));
    EXPECT_GT(cube.faces().size(), 20U);
    const std::vector<std::vector<int>> faces = merged_faces(cube);
    ASSERT_EQ(faces.size(), 6U) << i;
    ASSERT_EQ(count_edges(faces), 12U) << i;
    for (const std::vector<int>& face : faces) ASSERT_EQ(face.size(), 4U) << i;
  }
}

TEST(Solids, NamesMayHaveOtherSeparators) {
  EXPECT_EQ(solid_vertices("truncated_cube"), solid_vertices("truncated cube"));
  EXPECT_EQ(solid_vertices("snub-cube"), solid_vertices("snub cube"));
}

TEST(Solids, RefuseOtherNames) {
  const std::string message = message_of([] { return solid_vertices("cubes"); });
  EXPECT_EQ(message.rfind("the name of a solid is \"cubes\"; accepted: tetrahedron, cube, octahedron, ", 0), 0U);
  EXPECT_NE(message.find("snub dodecahedron"), std::string::npos);
}

}  // namespace
}  // namespace geom
