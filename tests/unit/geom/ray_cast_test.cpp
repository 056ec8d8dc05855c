#include "common/geom/query_shapes.h"
#include "common/geom/random.h"

#include <geom/geom.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <cmath>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::for_each_shape;
using geom_test::kNeedle;
using geom_test::Random;

/// Rays towards known points of the surface, from outside.
TEST(RayCast, HitsThePointItIsAimedAt) {
  Random random(6);
  for_each_shape([&](const auto& shape) {
    for (int k = 0; k < 500; ++k) {
      const Pose X = random.pose(1.0);
      const Vector3d n = random.direction();
      const Vector3d target = shape.support(n).point;
      // Against the normal by at least 0.1: a convex body is not met before.
      Vector3d back = random.direction();
      if (back.dot(n) < 0.1) back += (0.1 - back.dot(n) + random.uniform(0, 1)) * n;
      const double speed = random.log_uniform(0.1, 10);
      const double t = random.log_uniform(0.01, 10);
      const Vector3d origin = X.to_world(target + t * speed * back.normalized());
      const RayHit hit = ray_cast(shape, X, origin, X.rotation() * (-speed * back.normalized()));
      ASSERT_EQ(hit.status, RayStatus::hit);
      const double size = shape.bounding_radius() + t * speed + X.position().norm();
      ASSERT_NEAR(hit.t, t, 3e-13 * size / speed);
      ASSERT_LE((hit.point - X.to_world(target)).norm(), 3e-13 * size);
    }
  });
}

TEST(RayCast, MissesStartsInsideAndPointsAway) {
  for_each_shape([&](const auto& shape) {
    const double R = shape.bounding_radius();
    EXPECT_EQ(ray_cast(shape, Pose(), {2 * R, 0, 0}, {1, 0, 0}).status, RayStatus::missed);
    EXPECT_EQ(ray_cast(shape, Pose(), {2 * R, 1.01 * R, 0}, {-1, 0, 0}).status, RayStatus::missed);
    const RayHit inside = ray_cast(shape, Pose(), {0, 0, 0.1 * R}, {0, 0, 1});
    EXPECT_EQ(inside.status, RayStatus::inside);
    EXPECT_EQ(inside.t, 0);
    EXPECT_EQ(ray_cast(shape, Pose(), {2 * R, 0, 0}, {0, 0, 0}).status, RayStatus::not_converged);
  });
  EXPECT_NEAR(ray_cast(kNeedle, Pose(), {0, 0, 10}, {0, 0, -2}).t, 3.5, 1e-15);
}

/// Bodies with faces and edges, without, and with vertices and ridges.
template <class Check>
void for_each_exponent(const Check& check) {
  for (const double e : {0.2, 1.0, 1.6}) {
    check(Superellipsoid({1, 2, 1.5}, e, e));
  }
}

/// The length to which a ray is said to meet the surface: the contract of ray_cast.
double ray_tolerance(const Superellipsoid& shape, const Vector3d& origin) {
  return 2e-14 * (shape.bounding_radius() + origin.norm());
}

void expect_on_surface(const Superellipsoid& shape, const Vector3d& origin, const RayHit& hit) {
  const ClosestPoint closest = closest_point(shape, Pose(), hit.point);
  ASSERT_LE(std::abs(closest.distance), ray_tolerance(shape, origin)) << shape.e1();
}

/// A direction across n.
Vector3d tangent(const Vector3d& n, Random& random) {
  return n.cross(random.direction()).normalized();
}

/// Casts rays along tangents of the surface, a little above it and a little below. Some of the normals are those of
/// edges and ridges, where a support point is the same for many of them.
TEST(RayCast, GrazesTheSurface) {
  Random random(8);
  for_each_exponent([&](const Superellipsoid& shape) {
    for (int k = 0; k < 600; ++k) {
      Vector3d n = random.direction();
      if (k % 3 == 0) n = Vector3d(1, 1, 0) + random.log_uniform(1e-9, 0.1) * random.direction();
      if (k % 3 == 1) n = Vector3d::Unit(k % 9 / 3) + random.log_uniform(1e-9, 0.1) * random.direction();
      n.normalize();
      const Vector3d u = tangent(n, random);
      const Vector3d on_surface = shape.support(n).point;
      const double way = random.uniform(1, 5);
      const double off = random.log_uniform(1e-12, 1e-3);
      // The tangent plane separates the ray from the body.
      const Vector3d above = on_surface + off * n - way * u;
      ASSERT_EQ(ray_cast(shape, Pose(), above, u).status, RayStatus::missed) << shape.e1() << ' ' << off;
      const Vector3d inside = on_surface - off * n;
      const Vector3d below = inside - way * u;
      if (!contains(shape, Pose(), inside) || contains(shape, Pose(), below)) continue;
      const RayHit hit = ray_cast(shape, Pose(), below, u);
      ASSERT_EQ(hit.status, RayStatus::hit) << shape.e1() << ' ' << off;
      ASSERT_LE(hit.t, way + ray_tolerance(shape, below) / off);
      expect_on_surface(shape, below, hit);
    }
  });
}

/// Parallel to a face, through x = 1 - d, z = 0: |x|^p + |y/2|^p = 1, p = 2/e, says where the surface is.
TEST(RayCast, ParallelToAFace) {
  for_each_exponent([&](const Superellipsoid& shape) {
    const double p = 2 / shape.e2();
    for (const double d : {1e-12, 1e-9, 1e-6, 1e-3, 0.1}) {
      const Vector3d outside(1 + d, -5, 0);
      EXPECT_EQ(ray_cast(shape, Pose(), outside, {0, 2, 0}).status, RayStatus::missed) << shape.e2() << ' ' << d;
      const Vector3d origin(1 - d, -5, 0);
      const RayHit hit = ray_cast(shape, Pose(), origin, {0, 2, 0});
      ASSERT_EQ(hit.status, RayStatus::hit) << shape.e2() << ' ' << d;
      const double y = 2 * std::pow(-std::expm1(p * std::log1p(-d)), 1 / p);
      // The ray meets the surface to a length across it, times the slope dy/dx (and 1 - d is rounded).
      const double slope = y / (p * d);
      EXPECT_NEAR(2 * hit.t, 5 - y, ray_tolerance(shape, origin) * (1 + slope)) << shape.e2() << ' ' << d;
      expect_on_surface(shape, origin, hit);
    }
  });
}

TEST(RayCast, ThroughTheCentre) {
  Random random(9);
  for_each_exponent([&](const Superellipsoid& shape) {
    for (int k = 0; k < 300; ++k) {
      const Vector3d u = k < 3 ? Vector3d(Vector3d::Unit(k)) : random.direction();
      const double way = 5;
      const RayHit hit = ray_cast(shape, Pose(), -way * u, 3 * u);
      ASSERT_EQ(hit.status, RayStatus::hit);
      // N(u x) = x N(u), and value = N^2 - 1.
      ASSERT_NEAR(3 * hit.t, way - 1 / std::sqrt(1 + shape.value(u)), 1e-13 * way) << shape.e1();
      expect_on_surface(shape, -way * u, hit);
      const RayHit from_centre = ray_cast(shape, Pose(), Vector3d::Zero(), u);
      ASSERT_EQ(from_centre.status, RayStatus::inside);
      ASSERT_EQ(from_centre.t, 0);
    }
  });
}

/// Casts rays from the surface, where rounding decides on which side of it the origin is.
template <class AnyShape>
void expect_in_the_body_at_once(const AnyShape& shape, const Pose& X, const Vector3d& on_surface, const Vector3d& n,
                                Random& random) {
  for (const Vector3d& u : {n, Vector3d(-n), tangent(n, random)}) {
    const RayHit hit = ray_cast(shape, X, X.to_world(on_surface), X.rotation() * u);
    ASSERT_TRUE(hit.status == RayStatus::hit || hit.status == RayStatus::inside);
    ASSERT_EQ(hit.t, 0);
    ASSERT_NEAR(hit.normal.norm(), 1, 1e-12);
    ASSERT_LE((X.to_body(hit.point) - on_surface).norm(), 4e-14 * (1 + on_surface.norm()));
  }
}

template <class Concrete>
void expect_rays_from_the_surface_at_once(const Concrete& shape, Random& random) {
  for (int k = 0; k < 300; ++k) {
    const Vector3d n = k < 3 ? Vector3d(Vector3d::Unit(k)) : random.direction();
    const Vector3d on_surface = shape.support(n).point;
    const Pose X = k % 2 == 0 ? Pose() : random.pose(1.0);
    expect_in_the_body_at_once(shape, X, on_surface, n, random);
    expect_in_the_body_at_once(Shape(shape), X, on_surface, n, random);
  }
}

TEST(RayCast, FromTheSurfaceIsInTheBodyAtOnce) {
  Random random(10);
  for (const Vector3d& axes : {Vector3d(1, 1, 1), Vector3d(2, 1, 3), Vector3d(1e-3, 1, 0.1), Vector3d(1, 30, 1)}) {
    expect_rays_from_the_surface_at_once(Ellipsoid(axes), random);
  }
  for_each_exponent([&](const Superellipsoid& shape) { expect_rays_from_the_surface_at_once(shape, random); });
  expect_rays_from_the_surface_at_once(Superellipsoid({2, 1, 3}, 1, 1), random);
}

/// Tangents of the surface meet it to rounding, one length before and behind the point: the closed form says so as the
/// walk along the closest points does.
TEST(RayCast, TangentsOfEllipsoidsMeetThemToRounding) {
  Random random(11);
  for (const Vector3d& axes : {Vector3d(1, 1, 1), Vector3d(2, 1, 3), Vector3d(0.1, 1, 0.3)}) {
    const Ellipsoid shape(axes);
    for (int k = 0; k < 300; ++k) {
      const Vector3d n = random.direction();
      const Vector3d u = tangent(n, random);
      const Vector3d on_surface = shape.support(n).point;
      ASSERT_EQ(ray_cast(shape, Pose(), on_surface - u, u).status, RayStatus::hit);
      ASSERT_EQ(ray_cast(shape, Pose(), on_surface + 1e-12 * n - u, u).status, RayStatus::missed);
      ASSERT_EQ(ray_cast(shape, Pose(), on_surface + u, u).status, RayStatus::missed);
    }
  }
}

}  // namespace
}  // namespace geom
