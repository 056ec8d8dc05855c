// Boxes and polyhedra beside smooth bodies: distances that are known because features of both are placed a gap apart
// along a normal.

#include "cores/polytope_smooth.h"
#include "common/full_form.h"
#include "common/geom/core_pairs.h"
#include "common/geom/random.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;

/// Largest errors of some pairs, and how many of them were left to the general method.
struct FeatureErrors {
  double error = 0;
  double bound = 0;
  double residual = 0;
  int pairs = 0;
  int slow = 0;
};

template <class Polytope, class Smooth>
void expect_known_distances(const Polytope& polytope, const Smooth& smooth, Random& random, FeatureErrors& tally) {
  const int pairs = geom_test::repetitions(full_form() ? 10000 : 600);
  for (int k = 0; k < pairs; ++k) {
    const double gap = random.log_uniform(1e-10, 10);
    const auto pair = geom_test::manufacture_features(polytope, k % 3, smooth, 0, gap, random);
    const double size = geom_test::extent_of(pair);
    const DistanceResult r = distance(polytope, pair.X_WA, smooth, pair.X_WB);
    const DistanceResult back = distance(smooth, pair.X_WB, polytope, pair.X_WA);
    ASSERT_EQ(r.status, DistanceStatus::separated) << "pair " << k;
    ASSERT_EQ(back.status, DistanceStatus::separated) << "pair " << k;
    EXPECT_EQ(back.distance, r.distance) << "pair " << k;
    EXPECT_LE((r.point_b - r.point_a - r.distance * r.normal).norm(), 1e-15 * size);
    EXPECT_LE(std::abs(r.distance - gap), r.error_bound + 1e-14 * size) << "pair " << k;
    tally.error = std::max(tally.error, std::abs(r.distance - gap) / size);
    tally.bound = std::max(tally.bound, r.error_bound / size);
    tally.residual = std::max(tally.residual, r.residual / size);
    ++tally.pairs;
    const auto core = kernel::CoreBody(polytope).bare().core();
    const DistanceResult by_feature = kernel::polytope_to_smooth(core, pair.X_WA, smooth, pair.X_WB, {});
    tally.slow += by_feature.status == DistanceStatus::not_converged ? 1 : 0;
  }
}

template <class Smooth>
void expect_known_distances(const char* name, const Smooth& smooth, double allowed) {
  Random random(71);
  FeatureErrors tally;
  expect_known_distances(Box({0.5, 0.8, 1.1}), smooth, random, tally);
  expect_known_distances(Box({0.05, 2, 5}), smooth, random, tally);
  expect_known_distances(Rounded<Box>(Box({0.4, 0.4, 0.9}), 0.1), smooth, random, tally);
  for (const int points : {4, 12, 60}) {
    expect_known_distances(geom_test::random_polyhedron(points, random), smooth, random, tally);
  }
  std::printf("%s: error %.1e, bound %.1e, residual %.1e, %d of %d without a feature\n", name, tally.error, tally.bound,
              tally.residual, tally.slow, tally.pairs);
  EXPECT_LE(tally.error, allowed) << name;
  EXPECT_LE(tally.bound, allowed) << name;
  EXPECT_LE(tally.slow, tally.pairs / 100) << name;
}

TEST(PolytopeDistance, FromEllipsoidsIsKnown) {
  expect_known_distances("ellipsoids", Ellipsoid({0.7, 1, 1.6}), 1e-13);
  expect_known_distances("spheres", Ellipsoid({1, 1, 1}), 1e-13);
  expect_known_distances("needles", Ellipsoid({0.1, 0.1, 5}), 1e-13);
  expect_known_distances("discs", Ellipsoid({2, 2, 0.05}), 1e-13);
}

TEST(PolytopeDistance, FromSuperellipsoidsIsKnown) {
  expect_known_distances("superballs", Superellipsoid({1, 1, 1}, 0.5, 0.5), 1e-13);
  expect_known_distances("rounded cubes", Superellipsoid({1, 1.5, 2}, 0.2, 0.2), 1e-12);
  // Edges of both: where the normal jumps along an edge, the general method's certificate counts.
  expect_known_distances("octahedra", Superellipsoid({1, 1.5, 2}, 1.5, 1.5), kWidestGap);
  expect_known_distances("rounded cylinders", Superellipsoid({1, 1, 2}, 0.3, 1), 1e-12);
}

// Bodies as small and as large as they may be: a point stands for a vertex, not a ball.
TEST(PolytopeDistance, IsKnownAtAllSizes) {
  Random random(72);
  for (const double scale : {1e-45, 1e-30, 1e30, 1e45}) {
    const Box box(scale * Vector3d(0.5, 0.8, 1.1));
    const Ellipsoid ellipsoid(scale * Vector3d(0.7, 1, 1.6));
    for (int k = 0; k < 60; ++k) {
      const double gap = scale * random.log_uniform(1e-3, 1);
      const auto pair = geom_test::manufacture_features(box, k % 3, ellipsoid, 0, gap, random);
      const DistanceResult r = distance(box, pair.X_WA, ellipsoid, pair.X_WB);
      EXPECT_NEAR(r.distance / scale, gap / scale, 1e-12) << scale;
    }
  }
}

// Warm starts find the same distance; bodies in touch and slightly in each other are left to the general method.
TEST(PolytopeDistance, IsTheSameFromWarmStarts) {
  Random random(73);
  const Box box({0.5, 0.8, 1.1});
  const Superellipsoid smooth({1, 1.5, 2}, 0.5, 0.5);
  for (int k = 0; k < 200; ++k) {
    const double gap = k % 4 == 0 ? -random.log_uniform(1e-12, 1e-3) : random.log_uniform(1e-10, 1);
    const auto pair = geom_test::manufacture_features(box, k % 3, smooth, 0, gap, random);
    const DistanceResult cold = distance(box, pair.X_WA, smooth, pair.X_WB);
    const DistanceResult warm = distance(box, pair.X_WA, smooth, pair.X_WB, {.start = cold.normal});
    const double size = geom_test::extent_of(pair);
    EXPECT_NEAR(warm.distance, cold.distance, cold.error_bound + warm.error_bound + 1e-14 * size);
    EXPECT_LE(cold.distance, gap + 1e-14 * size);
    EXPECT_GE(cold.distance + cold.error_bound, gap - 1e-14 * size);
  }
}

// The closest features of a corner and of what is beyond it change where the body passes: no answer is worse there.
TEST(PolytopeDistance, IsContinuousWhereFeaturesChange) {
  const Box box({1, 1, 1});
  const Ellipsoid ball({0.3, 0.4, 0.5});
  const Pose X_WB0 = Random(5).pose(0.0);
  double last = 0;
  for (int k = 0; k <= 4000; ++k) {
    const double x = -2 + 1e-3 * k;
    const DistanceResult r = distance(box, Pose(), ball, Pose(X_WB0.rotation(), Vector3d(x, 0.5 * x, 1.8)));
    ASSERT_EQ(r.status, DistanceStatus::separated);
    ASSERT_LE(r.error_bound, 1e-13);
    if (k > 0) {
      ASSERT_LE(std::abs(r.distance - last), 1.2e-3);
    }
    last = r.distance;
  }
}

}  // namespace
}  // namespace geom
