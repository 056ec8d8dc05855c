// The separating-axis test of oriented boxes against alternating projections, and at boxes placed exactly apart.

#include <geom/geom.h>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom::OrientedBox;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vector3d vector() { return {normal_(engine_), normal_(engine_), normal_(engine_)}; }
  Matrix3d rotation() {
    const Vector3d v = vector();
    return Eigen::Quaterniond(normal_(engine_), v.x(), v.y(), v.z()).normalized().toRotationMatrix();
  }
  OrientedBox box() { return {vector(), rotation(), {uniform(0.1, 1.5), uniform(0.1, 1.5), uniform(0.1, 1.5)}}; }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

Vector3d nearest_point(const OrientedBox& box, const Vector3d& x) {
  const Vector3d local = box.axes.transpose() * (x - box.centre);
  return box.centre + box.axes * local.cwiseMin(box.half_extents).cwiseMax(-box.half_extents);
}

/// The distance of two boxes, from above: von Neumann's alternating projections.
double distance(const OrientedBox& a, const OrientedBox& b) {
  Vector3d x = b.centre;
  double d = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vector3d y = nearest_point(a, x);
    x = nearest_point(b, y);
    d = (x - y).norm();
  }
  return d;
}

/// Half of the box's extent along the unit vector n.
double radius(const OrientedBox& box, const Vector3d& n) {
  return (box.axes.transpose() * n).cwiseAbs().dot(box.half_extents);
}

TEST(BoxesMeet, AgreesWithAlternatingProjections) {
  Random random(1);
  int meeting = 0;
  int apart = 0;
  for (int k = 0; k < 3000; ++k) {
    const OrientedBox a = random.box();
    const OrientedBox b = random.box();
    const double d = distance(a, b);
    if (d > 1e-3) {
      ++apart;
      ASSERT_FALSE(geom::boxes_meet(a, b)) << d;
    } else if (d < 1e-9) {
      ++meeting;
      ASSERT_TRUE(geom::boxes_meet(a, b)) << d;
    }
  }
  EXPECT_GT(meeting, 500);
  EXPECT_GT(apart, 500);
}

TEST(BoxesMeet, DecidesAtTheEdgeOfEachOfTheFifteenAxes) {
  Random random(2);
  int tried = 0;
  for (int k = 0; k < 4000; ++k) {
    const OrientedBox a = random.box();
    OrientedBox b = random.box();
    const int axis = k % 15;
    Vector3d n = axis < 3 ? Vector3d(a.axes.col(axis))
                          : (axis < 6 ? Vector3d(b.axes.col(axis - 3))
                                      : Vector3d(a.axes.col((axis - 6) / 3)).cross(b.axes.col((axis - 6) % 3)));
    if (n.norm() < 0.1) continue;
    n.normalize();
    const double size = a.half_extents.norm() + b.half_extents.norm();
    // A hair apart along that axis: never said to meet.
    b.centre = a.centre + (radius(a, n) + radius(b, n) + 1e-10 * size) * n;
    ASSERT_FALSE(geom::boxes_meet(a, b)) << axis;
    // Pushed together, boxes whose centres are that close along every axis meet.
    b.centre = a.centre + 0.2 * std::min(a.half_extents.minCoeff(), b.half_extents.minCoeff()) * n;
    ASSERT_TRUE(geom::boxes_meet(a, b)) << axis;
    ASSERT_TRUE(geom::boxes_meet(b, a)) << axis;
    ++tried;
  }
  EXPECT_GT(tried, 3000);
}

/// Parallel edges: their products are no axes but rounding errors.
TEST(BoxesMeet, OfParallelBoxes) {
  Random random(3);
  for (int k = 0; k < 500; ++k) {
    const OrientedBox a = random.box();
    OrientedBox b = random.box();
    b.axes = a.axes;
    const Vector3d reach = a.half_extents + b.half_extents;
    for (int axis = 0; axis < 3; ++axis) {
      Vector3d t = Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).cwiseProduct(reach);
      b.centre = a.centre + a.axes * (0.999999 * t);
      EXPECT_TRUE(geom::boxes_meet(a, b));
      t[axis] = 1.000001 * reach[axis];
      b.centre = a.centre + a.axes * t;
      EXPECT_FALSE(geom::boxes_meet(a, b));
    }
  }
}

TEST(OrientedBoxOf, AnEllipsoidTouchesAllSixFaces) {
  Random random(4);
  const geom::Ellipsoid shape({0.5, 1.25, 3});
  const geom::Pose pose(random.rotation(), random.vector());
  const OrientedBox box = geom::oriented_box(shape, pose);
  EXPECT_TRUE(box.half_extents.isApprox(shape.semi_axes(), 1e-15));
  EXPECT_TRUE(box.centre.isApprox(pose.position(), 1e-15));
  EXPECT_EQ(box.axes, pose.rotation());
}

TEST(OrientedBoxOf, ASuperellipsoidHoldsItsSurfaceAndTouchesAllSixFaces) {
  Random random(5);
  for (const auto& [e1, e2] : {std::pair{0.2, 0.2}, {0.5, 1.3}, {1.6, 0.7}, {1.0, 1.0}}) {
    const geom::Superellipsoid shape({0.5, 1.25, 3}, e1, e2);
    const geom::Pose pose(random.rotation(), random.vector());
    const OrientedBox box = geom::oriented_box(shape, pose);
    const auto within = [&](const Vector3d& n) {
      const Vector3d point = pose.position() + pose.rotation() * shape.support(pose.rotation().transpose() * n).point;
      const Vector3d local = box.axes.transpose() * (point - box.centre);
      return Vector3d(box.half_extents - local.cwiseAbs());
    };
    for (int k = 0; k < 1000; ++k) {
      ASSERT_GE(within(random.vector().normalized()).minCoeff(), -1e-14) << e1 << " " << e2;
    }
    for (int k = 0; k < 6; ++k) {
      const Vector3d face = (k < 3 ? 1 : -1) * box.axes.col(k % 3);
      EXPECT_NEAR(within(face)[k % 3], 0, 1e-14) << e1 << " " << e2;
    }
  }
}

}  // namespace
