#include "common/geom/expect.h"
#include "common/geom/manufactured.h"
#include "common/geom/query_shapes.h"
#include "common/geom/random.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::for_each_shape;
using geom_test::kBrick;
using geom_test::kNeedle;
using geom_test::kOcta;
using geom_test::Random;

TEST(Overlap, AgreesWithTheDistance) {
  Random random(1);
  for_each_shape([&](const auto& a) {
    for_each_shape([&](const auto& b) {
      int apart = 0;
      for (int k = 0; k < 200; ++k) {
        const double reach = a.bounding_radius() + b.bounding_radius();
        const Pose X_WA = random.pose(0);
        const Pose X_WB(random.pose(0).rotation(), random.uniform(0, 1) * reach * random.direction());
        const DistanceResult d = distance(a, X_WA, b, X_WB);
        const Answer answer = overlap(a, X_WA, b, X_WB, k % 2 == 0 ? Vector3d(Vector3d::Zero()) : d.normal);
        ASSERT_EQ(answer, d.distance > 0 ? Answer::no : Answer::yes) << d.distance;
        apart += d.distance > 0;
      }
      EXPECT_GT(apart, 20);
      EXPECT_LT(apart, 180);
    });
  });
}

/// A ball that counts how often its support function is evaluated.
struct CountingBall {
  double radius;
  int* count;
  Support support(const Vector3d& n) const {
    ++*count;
    return Ellipsoid(Vector3d::Constant(radius)).support(n);
  }
  Eigen::Matrix3d support_hessian(const Vector3d& n) const {
    return Ellipsoid(Vector3d::Constant(radius)).support_hessian(n);
  }
  double bounding_radius() const { return radius; }
  double inscribed_radius() const { return radius; }
};

/// Counts the evaluations for bodies apart, at random: nearly all are told by one across the line of centres, all by
/// one across the last normal.
TEST(Overlap, IsMostlyDecidedByOneEvaluation) {
  Random random(11);
  int apart = 0;
  int by_one = 0;
  for (int k = 0; k < 2000; ++k) {
    int count = 0;
    const CountingBall ball{0.5, &count};
    const double away = random.uniform(0, 6);
    const Pose X_WA = Pose::translation(away * random.direction());
    const Answer answer = overlap(ball, X_WA, kBrick, Pose());
    if (answer != Answer::no) continue;
    ++apart;
    by_one += count == 1;
    const DistanceResult d = distance(ball, X_WA, kBrick, Pose());
    count = 0;
    ASSERT_EQ(overlap(ball, X_WA, kBrick, Pose(), d.normal), Answer::no);
    ASSERT_EQ(count, 1) << d.distance;
  }
  EXPECT_GT(apart, 1000);
  EXPECT_GE(by_one, 0.9 * apart);
  int count = 0;
  EXPECT_EQ(overlap(CountingBall{0.5, &count}, Pose::translation({0, 0, 1}), kBrick, Pose()), Answer::yes);
  EXPECT_EQ(count, 0) << "the inscribed balls tell";
}

TEST(Overlap, OfBodiesThatNearlyTouch) {
  Random random(2);
  for (int k = 0; k < 1000; ++k) {
    const double gap = (k % 2 == 0 ? 1 : -1) * random.log_uniform(1e-12, 1e-3);
    const auto pair = geom_test::manufacture(kNeedle, kOcta, gap, random);
    ASSERT_EQ(overlap(kNeedle, pair.X_WA, kOcta, pair.X_WB), gap > 0 ? Answer::no : Answer::yes) << gap;
  }
}

using Exact = Eigen::Matrix<long double, 3, 1>;

/// h(n), n in the world, in long double.
long double exact_height(const Vector3d& semi_axes, double e1, double e2, const Pose& X, const Exact& n) {
  const Exact w = semi_axes.cast<long double>().cwiseProduct(X.rotation().cast<long double>().transpose() * n);
  const auto plane = [](long double u, long double v, double e) {
    const long double q = 2 / (2 - static_cast<long double>(e));
    return std::pow(std::pow(std::abs(u), q) + std::pow(std::abs(v), q), 1 / q);
  };
  return plane(plane(w.x(), w.y(), e2), w.z(), e1);
}

/// g(n), the same.
long double exact_lower_bound(const Superellipsoid& a, const Pose& X_WA, const Superellipsoid& b, const Pose& X_WB,
                              const Vector3d& n) {
  const Exact unit = n.cast<long double>().normalized();
  const Exact r = X_WB.position().cast<long double>() - X_WA.position().cast<long double>();
  return unit.dot(r) - exact_height(a.semi_axes(), a.e1(), a.e2(), X_WA, unit) -
         exact_height(b.semi_axes(), b.e1(), b.e2(), X_WB, -unit);
}

void expect_below(const Superellipsoid& a, const Pose& X_WA, const Superellipsoid& b, const Pose& X_WB,
                  const Vector3d& n) {
  const double bound = distance_lower_bound(a, X_WA, b, X_WB, n);
  const long double exact = exact_lower_bound(a, X_WA, b, X_WB, n);
  ASSERT_LE(bound, exact);
  const double size = (X_WB.position() - X_WA.position()).norm() + a.bounding_radius() + b.bounding_radius();
  ASSERT_GE(bound, exact - static_cast<long double>(4e-15 * size));
}

TEST(LowerBound, IsNeverAboveTheGapOfTheTangentPlanes) {
  Random random(13);
  const Superellipsoid flat({2, 1, 0.01}, 1, 1);
  for (const Superellipsoid* a : {&kBrick, &kOcta, &flat}) {
    for (const Superellipsoid* b : {&kBrick, &kOcta, &flat}) {
      for (int k = 0; k < 1000; ++k) {
        const Pose X_WA = random.pose(random.log_uniform(1e-3, 1e3));
        const double apart = random.log_uniform(1e-3, 10) * (a->bounding_radius() + b->bounding_radius());
        const Vector3d p_B = X_WA.position() + apart * random.direction();
        const Pose X_WB(random.pose(0).rotation(), p_B);
        const double length = random.log_uniform(1e-3, 1e3);
        expect_below(*a, X_WA, *b, X_WB, length * random.direction());
        if (testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

/// Flat and long bodies side by side, across them or nearly: the height is a small part of what its rounding comes of.
TEST(LowerBound, OfFlatBodiesNearlyAcrossThemIsNeverAboveTheGap) {
  Random random(14);
  for (const Vector3d& axes :
       {Vector3d(1, 1, 1e-4), Vector3d(1, 1, 1e-3), Vector3d(1, 1e-4, 1e-4), Vector3d(2, 1, 0.01)}) {
    for (const double e : {0.2, 0.6, 1.0, 1.6}) {
      const Superellipsoid shape(axes, e, e);
      for (int k = 0; k < 2000; ++k) {
        const Pose X_WA = random.pose(0);
        const Vector3d across = X_WA.rotation().col(2);
        const Pose X_WB(X_WA.rotation(), X_WA.position() + 3 * axes.z() * across);
        const double tilt = random.log_uniform(1e-17, 1) * (k % 2 == 0 ? 10 * axes.z() : 1);
        expect_below(shape, X_WA, shape, X_WB, across + tilt * random.direction());
        if (testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

TEST(LowerBound, IsNeverAboveTheDistanceAndReachesItAtTheNormal) {
  Random random(3);
  for (int k = 0; k < 1000; ++k) {
    const auto pair = geom_test::manufacture(kNeedle, kBrick, random.log_uniform(1e-6, 10), random);
    const double any = distance_lower_bound(kNeedle, pair.X_WA, kBrick, pair.X_WB, 3 * random.direction());
    // As exactly as B can be put.
    ASSERT_LE(any, pair.distance + 1e-15 * pair.size);
    const double best = distance_lower_bound(kNeedle, pair.X_WA, kBrick, pair.X_WB, 0.1 * pair.normal);
    ASSERT_NEAR(best, pair.distance, 1e-14 * pair.size);
  }
}

TEST(ClosestPoint, OfPointsOnTheNormalsOfTheSurface) {
  Random random(4);
  for_each_shape([&](const auto& shape) {
    for (int k = 0; k < 500; ++k) {
      const Pose X = random.pose(1.0);
      const Vector3d n = random.direction();
      const Support s = shape.support(n);
      const double gap = random.log_uniform(1e-9, 10);
      const ClosestPoint closest = closest_point(shape, X, X.to_world(s.point + gap * n));
      const double size = shape.bounding_radius() + gap + X.position().norm();
      ASSERT_EQ(closest.status, DistanceStatus::separated);
      ASSERT_NEAR(closest.distance, gap, 1e-13 * size);
      ASSERT_LE((X.to_world(s.point + gap * n) - closest.point - closest.distance * closest.normal).norm(),
                1e-14 * size);
      ASSERT_NEAR(X.to_body(closest.point).dot(n), s.height, 1e-9 * size);
    }
  });
}

TEST(ClosestPoint, OfPointsInside) {
  const ClosestPoint centre = closest_point(kNeedle, Pose(), Vector3d::Zero());
  EXPECT_EQ(centre.status, DistanceStatus::overlapping);
  EXPECT_NEAR(centre.distance, -1, 1e-14);
  EXPECT_NEAR(std::hypot(centre.point.x(), centre.point.y()), 1, 1e-6);
  EXPECT_NEAR(closest_point(kBrick, Pose(), {0, 0, 0}).distance, -1, 1e-14);
  EXPECT_NEAR(closest_point(kBrick, Pose(), {0.25, 0, 0}).distance, -0.75, 1e-14);
  Random random(5);
  for (int k = 0; k < 500; ++k) {
    // Within the smallest radius of curvature the foot of the normal is the closest point.
    const Vector3d n = random.direction();
    const double depth = kNeedle.min_curvature_radius() * random.uniform(0.01, 1);
    const Vector3d p = kNeedle.support(n).point - depth * n;
    const ClosestPoint closest = closest_point(kNeedle, Pose(), p);
    ASSERT_EQ(closest.status, DistanceStatus::overlapping);
    ASSERT_NEAR(closest.distance, -depth, 1e-14);
    ASSERT_LE((p - closest.point - closest.distance * closest.normal).norm(), 1e-14);
    ASSERT_TRUE(contains(kNeedle, Pose(), p));
  }
}

TEST(ClosestPoint, OfAPointThatIsNotFiniteIsDeclined) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(closest_point(kNeedle, Pose(), {nan, 0, 0}).status, DistanceStatus::not_converged);
  EXPECT_EQ(closest_point(kBrick, Pose(), {nan, 0, 0}).status, DistanceStatus::not_converged);
  EXPECT_FALSE(contains(kNeedle, Pose(), {nan, 0, 0}));
}

TEST(AnyShape, AnswersAsTheShapeInside) {
  Random random(7);
  const Shape shapes[] = {kNeedle, kBrick};
  for (int k = 0; k < 100; ++k) {
    const auto pair = geom_test::manufacture(kNeedle, kBrick, random.log_uniform(1e-6, 10), random);
    EXPECT_EQ(distance(shapes[0], pair.X_WA, shapes[1], pair.X_WB).distance,
              distance(kNeedle, pair.X_WA, kBrick, pair.X_WB).distance);
    EXPECT_EQ(overlap(shapes[0], pair.X_WA, shapes[1], pair.X_WB), Answer::no);
    const WitnessPair seed = dual_seed(shapes[0], pair.X_WA, shapes[1], pair.X_WB);
    EXPECT_EQ(seed.point_a, dual_seed(kNeedle, pair.X_WA, kBrick, pair.X_WB).point_a);
    EXPECT_EQ(centre_seed(shapes[0], pair.X_WA, shapes[1], pair.X_WB).point_b,
              centre_seed(kNeedle, pair.X_WA, kBrick, pair.X_WB).point_b);
    const DistanceResult newton =
        newton_distance(shapes[0], pair.X_WA, shapes[1], pair.X_WB, NewtonSystem::eight, seed);
    EXPECT_EQ(newton.status, newton_distance(kNeedle, pair.X_WA, kBrick, pair.X_WB, NewtonSystem::eight, seed).status);
    EXPECT_EQ(oriented_box(shapes[1], pair.X_WB).half_extents, oriented_box(kBrick, pair.X_WB).half_extents);
    EXPECT_EQ(distance_lower_bound(shapes[0], pair.X_WA, shapes[1], pair.X_WB, pair.normal),
              distance_lower_bound(kNeedle, pair.X_WA, kBrick, pair.X_WB, pair.normal));
  }
  const Vector3d p(3, 1, 2);
  EXPECT_EQ(closest_point(shapes[1], Pose(), p).distance, closest_point(kBrick, Pose(), p).distance);
  EXPECT_EQ(ray_cast(shapes[1], Pose(), p, -p).t, ray_cast(kBrick, Pose(), p, -p).t);
  EXPECT_FALSE(contains(shapes[1], Pose(), p));
  EXPECT_TRUE(contains(shapes[0], Pose(), {0, 0, 3}));
  EXPECT_EQ(volume(shapes[0]), kNeedle.volume());
  EXPECT_EQ(inertia(shapes[1], 2.0), kBrick.inertia(2.0));
  EXPECT_EQ(support(shapes[1], p).height, kBrick.support(p).height);
  EXPECT_EQ(bounding_radius(shapes[1]), kBrick.bounding_radius());
  EXPECT_EQ(inscribed_radius(shapes[1]), kBrick.inscribed_radius());
}

/// Flat and long bodies have stationary points with g < 0 though they are apart: neither `overlap` nor a local answer
/// may take one for an overlap, whatever normal they start from.
template <class ShapeA, class ShapeB>
void expect_apart(const ShapeA& a, const ShapeB& b, Random& random, long& unknown) {
  const double gap = random.log_uniform(1e-7, 1) * (a.bounding_radius() + b.bounding_radius());
  const auto pair = geom_test::manufacture(a, b, gap, random);
  for (const Vector3d& start : {Vector3d(Vector3d::Zero()), Vector3d(-pair.normal), random.direction()}) {
    const Answer answer = overlap(a, pair.X_WA, b, pair.X_WB, start);
    ASSERT_NE(answer, Answer::yes) << gap;
    if (answer == Answer::unknown) ++unknown;
    const DistanceResult local =
        distance(a, pair.X_WA, b, pair.X_WB, {.start = start, .penetration = Penetration::local});
    ASSERT_NE(local.status, DistanceStatus::overlapping) << gap;
    ASSERT_GE(local.error_bound, 0);
  }
}

Vector3d stretched_axes(Random& random) {
  const double most = random.log_uniform(1, 1e3);
  return {1, random.log_uniform(1 / most, 1), random.log_uniform(1 / most, 1)};
}

TEST(Queries, BodiesApartDoNotOverlapHoweverFlatAndFromAnyStart) {
  Random random(31);
  long unknown = 0;
  for (int k = 0; k < 4000; ++k) {
    expect_apart(Ellipsoid(stretched_axes(random)), Ellipsoid(stretched_axes(random)), random, unknown);
  }
  EXPECT_EQ(unknown, 0);
  for (int k = 0; k < 1000; ++k) {
    const Superellipsoid a(stretched_axes(random), random.uniform(0.3, 1.5), random.uniform(0.3, 1.5));
    const Superellipsoid b(stretched_axes(random), random.uniform(0.3, 1.5), random.uniform(0.3, 1.5));
    expect_apart(a, b, random, unknown);
  }
  EXPECT_LE(unknown, 30) << "of 3,000";
}

TEST(Queries, OverlapsAreYesBySharedPoints) {
  Random random(32);
  for (int k = 0; k < repetitions(2000); ++k) {
    const Superellipsoid a({1, random.uniform(0.5, 2), random.uniform(0.5, 2)}, random.uniform(0.3, 1.5),
                           random.uniform(0.3, 1.5));
    const double depth = random.log_uniform(1e-9, 1e-3);
    const auto pair = geom_test::manufacture(a, a, -depth, random);
    ASSERT_EQ(overlap(a, pair.X_WA, a, pair.X_WB), Answer::yes) << depth;
    const DistanceResult local = distance(a, pair.X_WA, a, pair.X_WB, {.penetration = Penetration::local});
    ASSERT_EQ(local.status, DistanceStatus::overlapping) << depth;
    const ClosestPoint inside = closest_point(a, pair.X_WA, pair.X_WA.position());
    ASSERT_GE(inside.error_bound, 0);
  }
}

}  // namespace
}  // namespace geom
