/// Closest points, points inside, rays and oriented boxes of spheres, capsules, boxes, polyhedra, cylinders, cones and
/// rounded ones.

#include "common/geom/core_pairs.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <limits>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;
using geom_test::random_polyhedron;
using geom_test::repetitions;

template <class Check>
void for_all_shapes(Random& random, const Check& check) {
  check(Sphere(0.7));
  check(Capsule(2, 0.5));
  check(Capsule(0, 0.5));
  check(Box({1, 2, 0.5}));
  check(random_polyhedron(12, random));
  check(Rounded<Box>(Box({1, 2, 0.5}), 0.3));
  check(Rounded<ConvexPolyhedron>(random_polyhedron(12, random), 0.3));
  check(Cylinder(2, 0.5));
  check(Cylinder(0.5, 2));
  check(Cone(2, 0.5));
  check(Cone(0.5, 2));
  check(Rounded<Cylinder>(Cylinder(1, 0.5), 0.3));
  check(Rounded<Cone>(Cone(2, 0.5), 0.3));
}

/// Points at a known height above a known tangent plane's point, and the point inside that is closest to that one.
TEST(CoreQueries, ClosestPointOfAPointAboveAFeatureIsKnown) {
  Random random(1);
  for_all_shapes(random, [&](const auto& shape) {
    for (int i = 0; i < repetitions(1000); ++i) {
      const Pose X = random.pose(3.0);
      const geom_test::CoreFeature f = geom_test::feature_of(shape, i % 3, random);
      const Vector3d s = X.to_world(geom_test::random_point(f, random));
      const Vector3d n = X.rotation() * f.n;
      const double height = random.log_uniform(1e-9, 10);
      const ClosestPoint c = closest_point(shape, X, s + height * n);
      ASSERT_EQ(c.status, DistanceStatus::separated) << i;
      ASSERT_NEAR(c.distance, height, 1e-14 * (10 + height)) << i;
      ASSERT_LE((c.point - s).norm(), 1e-13 * (10 + height)) << i;
      ASSERT_FALSE(contains(shape, X, s + height * n)) << i;
    }
  });
}

/// Depths inside are those of the nearest face; the normal leads there.
TEST(CoreQueries, PointsInsideHaveTheirDepth) {
  Random random(2);
  for_all_shapes(random, [&](const auto& shape) {
    for (int i = 0; i < repetitions(1000); ++i) {
      const Pose X = random.pose(3.0);
      const Vector3d p = X.to_world(random.uniform(0, 0.99) * shape.support(random.direction()).point);
      const ClosestPoint c = closest_point(shape, X, p);
      ASSERT_EQ(c.status, DistanceStatus::overlapping) << i;
      ASSERT_TRUE(contains(shape, X, p)) << i;
      ASSERT_LT(c.distance, 0) << i;
      ASSERT_LE((p + c.distance * -c.normal - c.point).norm(), 1e-14 * 10) << i;
      ASSERT_NEAR(closest_point(shape, X, c.point).distance, 0, 1e-14 * 10) << i;
      // No direction has a nearer way out.
      for (int k = 0; k < 20; ++k) {
        const Vector3d n = random.direction();
        const double gap = n.dot(p - X.position()) - shape.support(X.rotation().transpose() * n).height;
        ASSERT_LE(gap, c.distance + 1e-14 * 10) << i;
      }
    }
  });
}

TEST(CoreQueries, TheMiddleOfABodyHasADepth) {
  EXPECT_EQ(closest_point(Sphere(2), Pose(), Vector3d::Zero()).distance, -2);
  EXPECT_EQ(closest_point(Capsule(2, 0.5), Pose(), Vector3d(0, 0, 1)).distance, -0.5);
  EXPECT_EQ(closest_point(Box({1, 2, 3}), Pose(), Vector3d::Zero()).distance, -1);
  EXPECT_EQ(closest_point(Cylinder(2, 0.5), Pose(), Vector3d(0, 0, 1)).distance, -0.5);
  EXPECT_EQ(closest_point(Cylinder(2, 0.5), Pose(), Vector3d(0, 0, 1.75)).distance, -0.25);
  EXPECT_EQ(closest_point(Cone(4, 3), Pose(), Vector3d::Zero()).distance, -1);
}

/// Rays aimed at a point of the surface from outside enter there, and leave at a point of the surface.
TEST(CoreQueries, RaysEnterAndLeaveAtTheSurface) {
  Random random(3);
  for_all_shapes(random, [&](const auto& shape) {
    const double R = shape.bounding_radius();
    for (int i = 0; i < repetitions(1000); ++i) {
      const Pose X = random.pose(3.0);
      const Vector3d inside = X.to_world(random.uniform(0, 0.9) * shape.support(random.direction()).point);
      const Vector3d direction = random.log_uniform(0.1, 10) * random.direction();
      const Vector3d origin = inside - random.uniform(2, 10) * R * direction.normalized();
      const RayHit hit = ray_cast(shape, X, origin, direction);
      ASSERT_EQ(hit.status, RayStatus::hit) << i;
      ASSERT_NEAR(closest_point(shape, X, hit.point).distance, 0, 1e-13 * R + 1e-15 * 20) << i;
      ASSERT_LE((origin + hit.t * direction - hit.point).norm(), 1e-14 * (20 + 10 * R)) << i;
      ASSERT_LE(hit.normal.dot(direction), 1e-12) << i;
      // The exit, from outside and from inside.
      const RayHit exit = ray_exit(shape, X, origin, direction);
      ASSERT_EQ(exit.status, RayStatus::hit) << i;
      ASSERT_GE(exit.t, hit.t - 1e-13 * R) << i;
      ASSERT_NEAR(closest_point(shape, X, exit.point).distance, 0, 1e-13 * R + 1e-15 * 20) << i;
      ASSERT_GE(exit.normal.dot(direction), -1e-12) << i;
      const RayHit start = ray_cast(shape, X, inside, direction);
      ASSERT_EQ(start.status, RayStatus::inside) << i;
      ASSERT_EQ(start.t, 0) << i;
      const RayHit out = ray_exit(shape, X, inside, direction);
      ASSERT_EQ(out.status, RayStatus::hit) << i;
      ASSERT_LE((out.point - exit.point).norm(), 1e-6 * R) << i;  // grazing rays lose half the digits
      // Backwards there is nothing.
      ASSERT_EQ(ray_cast(shape, X, origin, -direction).status, RayStatus::missed) << i;
      ASSERT_EQ(ray_exit(shape, X, origin, -direction).status, RayStatus::missed) << i;
    }
  });
}

/// Rays in a plane that the body does not reach miss it; those in a plane just inside a face or vertex meet it.
TEST(CoreQueries, RaysBesideTheBodyMissIt) {
  Random random(4);
  for_all_shapes(random, [&](const auto& shape) {
    for (int i = 0; i < repetitions(1000); ++i) {
      const Pose X = random.pose(3.0);
      const geom_test::CoreFeature f = geom_test::feature_of(shape, i % 3, random);
      const Vector3d n = X.rotation() * f.n;
      const Vector3d s = X.to_world(geom_test::random_point(f, random));
      const Vector3d across = n.cross(random.direction()).normalized();
      const double gap = random.log_uniform(1e-9, 1);
      ASSERT_EQ(ray_cast(shape, X, s + gap * n - 5 * across, across).status, RayStatus::missed) << i;
      ASSERT_EQ(ray_exit(shape, X, s + gap * n - 5 * across, across).status, RayStatus::missed) << i;
      ASSERT_EQ(ray_cast(shape, X, s + gap * n, -n).status, RayStatus::hit) << i;
    }
  });
}

TEST(CoreQueries, OfNumbersThatAreNotFiniteAreDeclined) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Random random(5);
  for_all_shapes(random, [&](const auto& shape) {
    EXPECT_EQ(closest_point(shape, Pose(), Vector3d(nan, 0, 0)).status, DistanceStatus::not_converged);
    EXPECT_FALSE(contains(shape, Pose(), Vector3d(nan, 0, 0)));
    EXPECT_EQ(ray_cast(shape, Pose(), Vector3d(5, 0, 0), Vector3d(0, 0, 0)).status, RayStatus::not_converged);
    EXPECT_EQ(ray_cast(shape, Pose(), Vector3d(5, nan, 0), Vector3d(1, 0, 0)).status, RayStatus::not_converged);
    EXPECT_EQ(ray_exit(shape, Pose(), Vector3d(5, 0, 0), Vector3d(0, nan, 0)).status, RayStatus::not_converged);
  });
}

TEST(CoreQueries, OverlapAndLowerBoundAgreeWithTheDistance) {
  Random random(6);
  for_all_shapes(random, [&](const auto& a) {
    for_all_shapes(random, [&](const auto& b) {
      for (int i = 0; i < repetitions(50); ++i) {
        const Pose X_WA = random.pose(1.0), X_WB = random.pose(3.0);
        const DistanceResult r = distance(a, X_WA, b, X_WB);
        EXPECT_EQ(overlap(a, X_WA, b, X_WB), r.distance > 0 ? Answer::no : Answer::yes);
        EXPECT_LE(distance_lower_bound(a, X_WA, b, X_WB, random.direction()), r.distance);
        EXPECT_NEAR(distance_lower_bound(a, X_WA, b, X_WB, r.normal), r.distance, 1e-13);
      }
    });
  });
}

TEST(CoreQueries, OrientedBoxesTouchTheBody) {
  Random random(7);
  const Pose X = random.pose(3.0);
  EXPECT_EQ(oriented_box(Sphere(2), X).half_extents, Vector3d(2, 2, 2));
  EXPECT_EQ(oriented_box(Capsule(2, 0.5), X).half_extents, Vector3d(0.5, 0.5, 2.5));
  EXPECT_EQ(oriented_box(Cylinder(2, 0.5), X).half_extents, Vector3d(0.5, 0.5, 2));
  EXPECT_EQ(oriented_box(Cone(4, 0.5), X).half_extents, Vector3d(0.5, 0.5, 2));
  EXPECT_EQ(oriented_box(Box({1, 2, 3}), X).half_extents, Vector3d(1, 2, 3));
  EXPECT_EQ(oriented_box(Box({1, 2, 3}), X).centre, X.position());
  EXPECT_EQ(oriented_box(Rounded<Box>(Box({1, 2, 3}), 0.5), X).half_extents, Vector3d(1.5, 2.5, 3.5));
}

}  // namespace
}  // namespace geom
