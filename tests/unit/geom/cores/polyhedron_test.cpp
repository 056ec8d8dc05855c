/// ConvexPolyhedron: its hull, planes and moments, and refusals.

#include "common/geom/core_pairs.h"
#include "common/message_of.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;
using geom_test::random_polyhedron;
using geom_test::repetitions;
using test_common::message_of;

std::vector<Vector3d> corners(const Vector3d& half) {
  std::vector<Vector3d> all;
  for (int k = 0; k < 8; ++k) {
    all.emplace_back((k & 1 ? 1 : -1) * half.x(), (k & 2 ? 1 : -1) * half.y(), (k & 4 ? 1 : -1) * half.z());
  }
  return all;
}

/// Checks Euler's formula, and that no point is outside any plane.
void check_hull(const ConvexPolyhedron& p, const std::vector<Vector3d>& points) {
  ASSERT_EQ(p.vertex_count() - p.edge_count() + static_cast<int>(p.faces().size()), 2);
  const kernel::Hull& hull = *p.core().hull;
  for (const Vector3d& x : points) {
    for (std::size_t f = 0; f < hull.normals.size(); ++f) {
      ASSERT_LE(hull.normals[f].dot(x) - hull.offsets[f], 1e-13 * p.bounding_radius());
    }
  }
  for (std::size_t f = 0; f < hull.normals.size(); ++f) {
    for (const int k : hull.faces[f]) {
      ASSERT_NEAR(hull.normals[f].dot(p.vertex(k)), hull.offsets[f], 1e-12 * p.bounding_radius());
    }
  }
}

TEST(ConvexPolyhedron, OfCornersIsTheBox) {
  const Vector3d half(1, 2, 3);
  std::vector<Vector3d> points = corners(half);
  const ConvexPolyhedron p(points);
  EXPECT_EQ(p.vertex_count(), 8);
  EXPECT_EQ(p.edge_count(), 12);
  ASSERT_EQ(p.faces().size(), 6U);
  for (const auto& face : p.faces()) EXPECT_EQ(face.size(), 4U);
  EXPECT_NEAR(p.volume(), 48, 1e-13);
  EXPECT_LE((p.inertia(2) - Box(half).inertia(2)).norm(), 1e-14);
  EXPECT_LE(p.centre_of_mass().norm(), 1e-15);
  EXPECT_EQ(p.inscribed_radius(), 1);
  EXPECT_DOUBLE_EQ(p.bounding_radius(), Box(half).bounding_radius());
  EXPECT_EQ(p.description(), "polyhedron of 8 vertices and 6 faces");
  check_hull(p, points);
  EXPECT_NEAR(p.scaled(2).volume(), 8 * 48, 1e-12);
}

/// Points within faces, on edges, inside, and given twice are no vertices, in any order.
TEST(ConvexPolyhedron, LeavesOutPointsThatAreNoVertices) {
  Random random(1);
  for (int i = 0; i < repetitions(100); ++i) {
    std::vector<Vector3d> points = corners({1, 1, 1});
    for (const double x : {-1.0, -0.5, 0.0, 0.25, 1.0}) {
      for (const double y : {-1.0, 0.0, 0.5, 1.0}) {
        points.emplace_back(x, y, 1);
        points.emplace_back(-1, x, y);
        points.emplace_back(0.5 * x, 0.5 * y, 0.5);
      }
    }
    for (std::size_t k = points.size() - 1; k > 0; --k) {
      std::swap(points[k], points[static_cast<std::size_t>(random.uniform() * static_cast<double>(k + 1))]);
    }
    const ConvexPolyhedron p(points);
    ASSERT_EQ(p.vertex_count(), 8) << i;
    ASSERT_EQ(p.edge_count(), 12) << i;
    ASSERT_EQ(p.faces().size(), 6U) << i;
  }
}

/// Nearly coplanar points, an ulp off a face: decisions are exact, and the hull contains every point.
TEST(ConvexPolyhedron, IsConvexWherePointsAreAnUlpOffAFace) {
  Random random(2);
  for (int i = 0; i < repetitions(100); ++i) {
    std::vector<Vector3d> points = corners({1, 1, 1});
    for (int k = 0; k < 40; ++k) {
      Vector3d x(random.uniform(-1, 1), random.uniform(-1, 1), 1);
      const int ulps = static_cast<int>(3 * random.uniform());
      for (int u = 0; u < ulps; ++u) x.z() = std::nextafter(x.z(), 2.0);
      points.push_back(x);
    }
    const ConvexPolyhedron p(points);
    check_hull(p, points);
    if (HasFatalFailure()) return;
  }
}

TEST(ConvexPolyhedron, OfRandomPointsContainsThemAndHasTheirMoments) {
  Random random(3);
  for (const int count : {4, 5, 8, 20, 100, 400}) {
    const ConvexPolyhedron p = random_polyhedron(count, random);
    std::vector<Vector3d> points;
    for (int k = 0; k < p.vertex_count(); ++k) points.push_back(p.vertex(k));
    check_hull(p, points);
    // The volume by the divergence theorem, and the support heights by all vertices.
    const kernel::Hull& hull = *p.core().hull;
    double volume = 0;
    for (std::size_t f = 0; f < hull.faces.size(); ++f) {
      Vector3d area = Vector3d::Zero();
      for (std::size_t k = 0; k < hull.faces[f].size(); ++k) {
        area += p.vertex(hull.faces[f][k]).cross(p.vertex(hull.faces[f][(k + 1) % hull.faces[f].size()]));
      }
      volume += area.norm() / 6 * hull.offsets[f];
    }
    EXPECT_NEAR(p.volume(), volume, 1e-12);
    for (int k = 0; k < 100; ++k) {
      const Vector3d n = random.direction();
      double height = -1;
      for (const Vector3d& v : points) height = std::max(height, n.dot(v));
      EXPECT_NEAR(p.support(n).height, height, 1e-15);
      EXPECT_TRUE(p.contains(random.uniform(0, 0.999) * p.support(n).point));
      EXPECT_FALSE(p.contains(1.001 * p.support(n).point));
    }
  }
}

/// Moments are those of random points inside.
TEST(ConvexPolyhedron, HasMomentsOfItsPoints) {
  Random random(4);
  const ConvexPolyhedron p = random_polyhedron(12, random);
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  int inside = 0;
  const int draws = repetitions(1000000);
  for (int k = 0; k < draws; ++k) {
    const Vector3d x(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (!p.contains(x)) continue;
    ++inside;
    first += x;
    second += x * x.transpose();
  }
  const double error = 5 / std::sqrt(static_cast<double>(inside));
  EXPECT_NEAR(8.0 * inside / draws, p.volume(), error * p.volume());
  EXPECT_LE((first / inside - p.centre_of_mass()).norm(), error);
  const Matrix3d mean = second / inside;
  EXPECT_LE((mean.trace() * Matrix3d::Identity() - mean - p.inertia_tensor(1)).norm(), error);
}

TEST(ConvexPolyhedron, InItsPrincipalFrameIsCentredAndDiagonal) {
  Random random(5);
  for (int i = 0; i < repetitions(200); ++i) {
    std::vector<Vector3d> points;
    for (int k = 0; k < 10; ++k) {
      points.emplace_back(Vector3d(5, -3, 2) + random.direction().cwiseProduct(Vector3d(1, 2, 3)));
    }
    Pose X_BP;
    const ConvexPolyhedron p = ConvexPolyhedron::in_principal_frame(points, &X_BP);
    ASSERT_LE(p.centre_of_mass().norm(), 1e-13);
    const Matrix3d tensor = p.inertia_tensor(1);
    ASSERT_LE((tensor - Matrix3d(tensor.diagonal().asDiagonal())).norm(), 1e-12);
    for (int k = 0; k < p.vertex_count(); ++k) {
      const Vector3d x = X_BP.to_world(p.vertex(k));
      ASSERT_TRUE(std::any_of(points.begin(), points.end(), [&](const Vector3d& q) { return (q - x).norm() < 1e-13; }));
    }
  }
  // A symmetric body keeps its axes.
  const ConvexPolyhedron cube = ConvexPolyhedron::in_principal_frame(corners({1, 1, 1}));
  EXPECT_EQ(cube.vertex(0).cwiseAbs(), Vector3d(1, 1, 1));
}

TEST(ConvexPolyhedron, RefusesDegeneratePointsWithOneMessage) {
  const auto hull = [](const std::vector<Vector3d>& points) {
    return message_of([&] { return ConvexPolyhedron(points); });
  };
  EXPECT_EQ(hull({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), "ConvexPolyhedron: 3 points; accepted: at least 4");
  EXPECT_EQ(hull({{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0.5, 0.5, 0}}),
            "ConvexPolyhedron: the 5 points lie in a plane; accepted: points that span a volume");
  EXPECT_EQ(hull({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}),
            "ConvexPolyhedron: the 4 points lie in a plane; accepted: points that span a volume");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(hull({{1, 0, 0}, {0, nan, 0}, {-1, 0, 0}, {0, -1, 0}}),
            "ConvexPolyhedron: coordinate y of point 1 is nan; accepted: magnitudes up to 1e+50");
  EXPECT_EQ(hull({{1, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 0, 1}}),
            "ConvexPolyhedron: the origin is not inside the hull of the points; accepted: points around it "
            "(in_principal_frame moves them)");
  const std::vector<Vector3d> flat = corners({1, 1, 1e-6});
  EXPECT_NE(hull(flat).find("accepted: a ratio of at most 10000"), std::string::npos) << hull(flat);
}

}  // namespace
}  // namespace geom
