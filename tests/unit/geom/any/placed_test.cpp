/// Placed and AnyConvex: every query gives what the shapes inside give at the products of their poses.

#include "common/geom/core_pairs.h"
#include "common/geom/shapes.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <vector>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;
using geom_test::repetitions;

static_assert(SupportShape<Placed<Cone>> && PointSet<Placed<Cone>> && !CoreShape<Placed<Cone>>);
static_assert(SupportShape<AnyConvex> && SupportShape<Placed<AnyConvex>>);

void expect_equal_answers(const DistanceResult& a, const DistanceResult& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.point_a, b.point_a);
  EXPECT_EQ(a.point_b, b.point_b);
  EXPECT_EQ(a.error_bound, b.error_bound);
}

TEST(Placed, HasTheSupportOfItsPlace) {
  Random random(1);
  const Placed<Cone> body(Cone(2, 0.7), random.pose(3.0));
  for (int i = 0; i < 100; ++i) {
    const Vector3d n = random.log_uniform(0.1, 10) * random.direction();
    const Support s = body.support(n);
    EXPECT_NEAR(s.height, n.dot(s.point), 1e-13 * n.norm());
    EXPECT_NEAR(s.height,
                n.dot(body.pose().position()) + body.inner().support(body.pose().rotation().transpose() * n).height,
                1e-13 * n.norm());
    EXPECT_LE((body.support_hessian(n) * n).norm(), 1e-12);
    EXPECT_LE(s.point.norm(), body.bounding_radius() + 1e-14);
  }
  EXPECT_EQ(body.inscribed_radius(), 0);  // the origin is outside
  EXPECT_EQ(Placed<Box>(Box({1, 2, 3}), Pose::translation({0.25, 0, 0})).inscribed_radius(), 0.75);
  EXPECT_TRUE(body.contains(body.pose().position()));
}

/// Moments about the body's origin: those of points of the shape.
TEST(Placed, HasTheMomentsOfItsPlace) {
  Random random(2);
  const auto check = [&](const auto& shape) {
    const Placed body(shape, random.pose(2.0));
    Matrix3d sum = Matrix3d::Zero();
    Vector3d centre = Vector3d::Zero();
    const int points = 200000;
    int inside = 0;
    const double R = shape.bounding_radius();
    for (int i = 0; i < points; ++i) {
      const Vector3d x(random.uniform(-R, R), random.uniform(-R, R), random.uniform(-R, R));
      if (!shape.contains(x)) continue;
      const Vector3d y = body.pose().to_world(x);
      sum += y.squaredNorm() * Matrix3d::Identity() - y * y.transpose();
      centre += y;
      ++inside;
    }
    EXPECT_LE((body.centre_of_mass() - centre / inside).norm(), 0.02 * R);
    const Matrix3d tensor = body.inertia_tensor(3);
    EXPECT_LE((tensor - 3 * sum / inside).norm(), 0.02 * tensor.norm());
  };
  check(Box({1, 2, 0.5}));
  check(Cone(2, 0.7, -1.5));
  EXPECT_EQ(Placed<Box>(Box({1, 2, 3}), Pose()).volume(), 48);
}

TEST(Placed, HasTheQueriesOfItsPlace) {
  Random random(3);
  const Cylinder cylinder(1, 0.5);
  const Superellipsoid brick({1, 2, 1.5}, 0.5, 0.4);
  for (int i = 0; i < repetitions(200); ++i) {
    const Pose X_BI = random.pose(2.0), X_CJ = random.pose(2.0), X_WA = random.pose(3.0), X_WB = random.pose(3.0);
    const Placed<Cylinder> a(cylinder, X_BI);
    const Placed<Superellipsoid> b(brick, X_CJ);
    const Pose X_WI = X_WA * X_BI, X_WJ = X_WB * X_CJ;
    expect_equal_answers(distance(a, X_WA, b, X_WB), distance(cylinder, X_WI, brick, X_WJ));
    expect_equal_answers(distance(a, X_WA, brick, X_WB), distance(cylinder, X_WI, brick, X_WB));
    expect_equal_answers(distance(cylinder, X_WA, b, X_WB), distance(cylinder, X_WA, brick, X_WJ));
    EXPECT_EQ(overlap(a, X_WA, b, X_WB), overlap(cylinder, X_WI, brick, X_WJ));
    EXPECT_EQ(overlap(a, X_WA, brick, X_WB), overlap(cylinder, X_WI, brick, X_WB));
    EXPECT_EQ(overlap(cylinder, X_WA, b, X_WB), overlap(cylinder, X_WA, brick, X_WJ));
    const Vector3d n = random.direction(), p = 3 * random.direction();
    EXPECT_EQ(distance_lower_bound(a, X_WA, b, X_WB, n), distance_lower_bound(cylinder, X_WI, brick, X_WJ, n));
    EXPECT_EQ(distance_lower_bound(a, X_WA, brick, X_WB, n), distance_lower_bound(cylinder, X_WI, brick, X_WB, n));
    EXPECT_EQ(distance_lower_bound(cylinder, X_WA, b, X_WB, n), distance_lower_bound(cylinder, X_WA, brick, X_WJ, n));
    EXPECT_EQ(closest_point(a, X_WA, p).point, closest_point(cylinder, X_WI, p).point);
    EXPECT_EQ(contains(b, X_WB, p), contains(brick, X_WJ, p));
    const Vector3d to = X_WI.position() - p;
    EXPECT_EQ(ray_cast(a, X_WA, p, to).t, ray_cast(cylinder, X_WI, p, to).t);
    EXPECT_EQ(ray_exit(a, X_WA, p, to).t, ray_exit(cylinder, X_WI, p, to).t);
    EXPECT_EQ(oriented_box(a, X_WA).centre, oriented_box(cylinder, X_WI).centre);
  }
  // A floor takes any support function.
  EXPECT_EQ(distance(HalfSpace(), Pose(), Placed<Cylinder>(cylinder, Pose::translation({0, 0, 2})), Pose()).distance,
            1);
}

/// The origin of neither body is inside it.
TEST(Placed, OverlapsWhereItsShapeDoes) {
  const Placed<Sphere> left(Sphere(1), Pose::translation({-5, 0, 0})), right(Sphere(1), Pose::translation({5, 0, 0}));
  EXPECT_EQ(overlap(left, Pose(), right, Pose()), Answer::no);
  EXPECT_EQ(overlap(left, Pose(), Sphere(1), Pose()), Answer::no);
  EXPECT_EQ(overlap(AnyConvex(left), Pose(), AnyConvex(right), Pose()), Answer::no);
  EXPECT_EQ(overlap(left, Pose::translation({9, 0, 0}), right, Pose()), Answer::yes);
  EXPECT_EQ(overlap(AnyConvex(left), Pose::translation({9, 0, 0}), AnyConvex(right), Pose()), Answer::yes);
}

/// Shapes of all forms, and what distance() of them by their own types gives.
TEST(AnyConvex, HasTheAnswersOfItsShape) {
  Random random(4);
  const Pose place = random.pose(1.0);
  const Ellipsoid egg({1, 0.7, 0.5});
  const auto pairs = [&](const auto& check) {
    const auto with_all = [&](const auto& a) {
      check(a, egg);
      check(a, Superellipsoid({1, 0.7, 0.5}, 0.5, 0.6));
      check(a, Cylinder(1, 0.5));
      check(a, Rounded<Cone>(Cone(1, 0.5), 0.1));
      check(a, Rounded<Ellipsoid>(egg, 0.2));
      check(a, Placed<Box>(Box({1, 0.5, 0.3}), place));
      check(a, geom_test::Spherocylinder{1, 0.4});
    };
    with_all(egg);
    with_all(Superellipsoid({1, 0.7, 0.5}, 0.5, 0.6));
    with_all(Capsule(1, 0.5));
    with_all(Placed<Rounded<Ellipsoid>>(Rounded<Ellipsoid>(egg, 0.2), place));
    with_all(geom_test::Spherocylinder{1, 0.4});
  };
  pairs([&](const auto& a, const auto& b) {
    const AnyConvex any_a(a), any_b(b);
    for (int i = 0; i < repetitions(20); ++i) {
      const Pose X_WA = random.pose(1.0), X_WB = random.pose(Vector3d(X_WA.position() + 3 * random.direction()));
      const double size = 3 + any_a.bounding_radius() + any_b.bounding_radius();
      const DistanceResult own = distance(a, X_WA, b, X_WB), any = distance(any_a, X_WA, any_b, X_WB);
      EXPECT_EQ(any.status, own.status);
      EXPECT_NEAR(any.distance, own.distance, 1e-12 * size + own.error_bound + any.error_bound);
      EXPECT_LE((any.point_a + any.distance * any.normal - any.point_b).norm(), 1e-14 * size);
      EXPECT_EQ(overlap(any_a, X_WA, any_b, X_WB), own.distance > 0 ? Answer::no : Answer::yes);
      const Vector3d n = random.direction();
      EXPECT_NEAR(distance_lower_bound(any_a, X_WA, any_b, X_WB, n), distance_lower_bound(a, X_WA, b, X_WB, n),
                  1e-14 * size);
      EXPECT_NEAR(any_b.support(n).height, b.support(n).height, 1e-14 * size);
      EXPECT_LE((any_b.support_hessian(n) - b.support_hessian(n)).norm(), 1e-13 * size);
    }
  });
}

/// Points and rays, balls swept over smooth shapes included.
TEST(AnyConvex, HasTheQueriesOfItsShape) {
  Random random(5);
  const auto check = [&](const auto& shape) {
    const AnyConvex any(shape);
    for (int i = 0; i < repetitions(50); ++i) {
      const Pose X = random.pose(1.0);
      const Vector3d p = X.position() + random.log_uniform(0.01, 5) * random.direction();
      const ClosestPoint own = closest_point(shape, X, p), c = closest_point(any, X, p);
      EXPECT_EQ(c.status, own.status);
      EXPECT_NEAR(c.distance, own.distance, 1e-12 * 5 + own.error_bound + c.error_bound);
      EXPECT_NEAR(closest_point(shape, X, c.point).distance, 0, 1e-8);
      if (std::abs(own.distance) > 1e-6) {
        EXPECT_EQ(contains(any, X, p), own.distance < 0);
      }
      const Vector3d origin = X.position() + 4 * random.direction(), to = X.position() - origin;
      const RayHit hit = ray_cast(any, X, origin, to);
      EXPECT_EQ(hit.status, ray_cast(shape, X, origin, to).status);
      EXPECT_NEAR(hit.t, ray_cast(shape, X, origin, to).t, 1e-12);
      EXPECT_NEAR(ray_exit(any, X, origin, to).t, ray_exit(shape, X, origin, to).t, 1e-12);
    }
  };
  check(Ellipsoid({1, 0.7, 0.5}));
  check(Cone(1, 0.5));
  check(Rounded<Box>(Box({1, 0.5, 0.3}), 0.1));
  check(Rounded<Ellipsoid>(Ellipsoid({1, 0.7, 0.5}), 0.2));
}

TEST(AnyConvex, HoldsShapesChosenAtRunTime) {
  const Shape shape = Rounded<Box>(Box({1, 2, 3}), 0.5);
  const AnyConvex any(shape);
  EXPECT_EQ(any.bounding_radius(), bounding_radius(shape));
  EXPECT_EQ(any.inscribed_radius(), 1.5);
  EXPECT_EQ(any.min_curvature_radius(), 0.5);
  EXPECT_TRUE(any.part().shape->core());
  const AnyConvex moved(Placed<AnyConvex>(any, Pose::translation({4, 0, 0})));
  EXPECT_EQ(distance(moved, Pose(), AnyConvex(Sphere(1)), Pose()).distance, 1.5);
  EXPECT_EQ(AnyConvex(moved).part().X_BI.position(), Vector3d(4, 0, 0));
}

}  // namespace
}  // namespace geom
