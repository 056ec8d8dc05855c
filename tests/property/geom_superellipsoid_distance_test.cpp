// Distances of superellipsoids whose answer is known before it is computed: B is placed so that the support points of a
// chosen normal are the witness points. Five ways to choose it, three of them where flat faces, edges and vertices make
// it hard. HARDBODY_FULL=1: 100,000 pairs of copies a cell and set instead of 500 (20,000 of unlike bodies), 28,000
// overlaps instead of 30 (2,000).

#include "property/superellipsoid_pairs.h"

#include "common/full_form.h"
#include "common/geom/manufactured.h"
#include "common/geom/random.h"
#include "common/geom/superellipsoid_sets.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>

namespace geom {
namespace {

struct AnswerTally {
  long pairs = 0;
  long wrong = 0;
  long declined = 0;
  double worst = 0;
  double bound = 0;        ///< largest `error_bound`, over the sum of both bounding radii
  double off_g = 0;        ///< largest |g(normal) - distance| over the size of the pair
  double above = 0;        ///< largest excess of a distance over the true one, over the size
  double off_normal = 0;   ///< largest angle to the known normal, over what distance.h promises
  double off_surface = 0;  ///< largest offset of a witness point, over the size

  AnswerTally& operator+=(const AnswerTally& t) {
    pairs += t.pairs;
    wrong += t.wrong;
    declined += t.declined;
    worst = std::max(worst, t.worst);
    bound = std::max(bound, t.bound);
    off_g = std::max(off_g, t.off_g);
    above = std::max(above, t.above);
    off_normal = std::max(off_normal, t.off_normal);
    off_surface = std::max(off_surface, t.off_surface);
    return *this;
  }
};

/// Returns the angle that error_bound leaves (distance.h), for bodies apart.
double promised_angle(const DistanceResult& r, double size) {
  return std::sqrt(2 * (r.error_bound + 1e-15 * size) / r.distance);
}

void try_pair(const Bodies& bodies, const SetTraits& traits, Random& random, AnswerTally& tally) {
  const auto& [a, b] = bodies;
  const Orientation o = choose(traits.set, a, b, random);
  const double gap = random.log_uniform(1e-8, 1);
  Pose X_WA, X_WB;
  place(o, a, b, gap, X_WA, X_WB);
  // What rounding has left of the gap: g at the chosen normal.
  const double wanted = geom_test::lower_bound(a, X_WA, b, X_WB, o.n);
  const DistanceResult r = distance(a, X_WA, b, X_WB);
  ++tally.pairs;
  if (r.status == DistanceStatus::not_converged) {
    ++tally.declined;
    return;
  }
  const double size = X_WB.position().norm() + bodies.radii();
  const double error = std::abs(r.distance - wanted) / size;
  tally.worst = std::max(tally.worst, error);
  if (!(error <= kTolerance) || r.status != DistanceStatus::separated) ++tally.wrong;
  const double scale = std::max(1.0, b.semi_axes().x());  // of the larger body: that of A is 1
  ASSERT_NEAR((r.point_b - r.point_a - r.distance * r.normal).norm(), 0, 1e-14 * scale);
  ASSERT_GE(r.distance + r.error_bound, wanted - 1e-15 * size) << "pair " << tally.pairs;
  const double g = geom_test::lower_bound(a, X_WA, b, X_WB, r.normal);
  tally.off_g = std::max(tally.off_g, std::abs(g - r.distance) / size);
  tally.above = std::max(tally.above, (r.distance - wanted) / size);
  tally.bound = std::max(tally.bound, r.error_bound / bodies.radii());
  tally.off_normal = std::max(tally.off_normal, (r.normal - o.n).norm() / promised_angle(r, size));
  tally.off_surface = std::max({tally.off_surface, geom_test::off_surface(a, X_WA, r.point_a) / size,
                                geom_test::off_surface(b, X_WB, r.point_b) / size});
  // The same from near the normal, from far off and from opposite to it.
  if (tally.pairs % 5 != 0) return;
  for (const Vector3d& start : {Vector3d(o.n + 1e-3 * random.direction()), Vector3d(random.direction()),
                                Vector3d(0.3 * random.direction() - o.n)}) {
    const DistanceResult warm = distance(a, X_WA, b, X_WB, {.start = start});
    if (warm.status == DistanceStatus::not_converged) {
      ++tally.declined;
      continue;
    }
    if (!(std::abs(warm.distance - wanted) / size <= kTolerance)) ++tally.wrong;
  }
}

template <class Make>
void expect_known_answers(const char* which, long pairs, const Make& make) {
  std::printf(
      "| set, %s | pairs | wrong | declined | largest error | largest error bound | points off the surfaces |\n",
      which);
  double off_normal = 0, off_g = 0, above = 0;
  for (const SetTraits& traits : kSets) {
    AnswerTally all;
    for_each_cell(traits.set, [&](double e1, double e2, Random& random) {
      AnswerTally cell;
      for (long k = 0; k < pairs; ++k) try_pair(make(k, e1, e2, random), traits, random, cell);
      const auto where = [&] { return testing::Message() << traits.name << ", e1 = " << e1 << ", e2 = " << e2; };
      EXPECT_EQ(cell.wrong, 0) << where();
      EXPECT_EQ(cell.declined, 0) << where();
      EXPECT_LE(cell.bound, kBoundGap) << where();
      EXPECT_LE(cell.above, 1e-15) << where() << ": more than rounding above";
      EXPECT_LE(cell.off_g, kTolerance) << where();
      EXPECT_LE(cell.off_normal, 1) << where();
      EXPECT_LE(cell.off_surface, traits.off_surface) << where();
      all += cell;
    });
    std::printf("| %s | %ld | %ld | %ld | %.1e | %.1e | %.1e |\n", traits.name, all.pairs, all.wrong, all.declined,
                all.worst, all.bound, all.off_surface);
    off_normal = std::max(off_normal, all.off_normal);
    off_g = std::max(off_g, all.off_g);
    above = std::max(above, all.above);
  }
  std::printf("normals off by %.2f of what their error bounds allow, gaps across them within %.1e of the size\n",
              off_normal, off_g);
  std::printf("distances above the true ones by %.1e of the size\n", above);
}

TEST(SuperellipsoidDistance, OfKnownAnswers) {
  expect_known_answers("copies", full_form() ? 100000 : 500, copies);
}

TEST(SuperellipsoidDistance, OfKnownAnswersOfUnlikeBodies) {
  expect_known_answers("unlike bodies", full_form() ? 20000 : 500, unlike);
}

/// Mixed pairs, and a superellipsoid that is an ellipsoid.
TEST(SuperellipsoidDistance, OfMixedPairs) {
  Random random(7);
  const Ellipsoid needle({0.5, 0.5, 2});
  const Superellipsoid same({0.5, 0.5, 2}, 1, 1);
  const Superellipsoid brick({1, 2, 1.5}, 0.5, 0.4);
  for (int k = 0; k < 2000; ++k) {
    const double gap = random.log_uniform(1e-9, 10);
    const auto pair = geom_test::manufacture(needle, brick, gap, random);
    const DistanceResult r = distance(needle, pair.X_WA, brick, pair.X_WB);
    ASSERT_EQ(r.status, DistanceStatus::separated);
    ASSERT_NEAR(r.distance, gap, 1e-13 * pair.size);
    const DistanceResult turned = distance(brick, pair.X_WB, needle, pair.X_WA);
    ASSERT_NEAR(turned.distance, gap, 1e-13 * pair.size);
    ASSERT_LT((turned.normal + r.normal).norm(), 1e-6);
    const DistanceResult warm = distance(same, pair.X_WA, brick, pair.X_WB, {.start = r.normal});
    ASSERT_NEAR(warm.distance, gap, 1e-13 * pair.size);
  }
}

/// A warm start may be any normal. About opposite to the true one flat bodies that are apart have stationary points
/// with g < 0: the cold start is tried then, not the search over all normals, which takes ten thousands of evaluations.
TEST(SuperellipsoidDistance, FromTheWrongSideWithoutASearch) {
  Random random(11);
  const Superellipsoid plate({11.7, 0.273, 7.75}, 0.2, 1.37);
  const Ellipsoid ball({4.5, 4.5, 4.5});
  for (int k = 0; k < 300; ++k) {
    const Pose X_WB = Pose::translation({0, random.uniform(-100, -10), random.uniform(-0.4, 0.4)});
    const DistanceResult cold = distance(plate, Pose(), ball, X_WB);
    ASSERT_EQ(cold.status, DistanceStatus::separated);
    const Vector3d start = -cold.normal + 0.1 * random.direction();
    const DistanceResult warm = distance(plate, Pose(), ball, X_WB, {.start = start});
    ASSERT_EQ(warm.status, DistanceStatus::separated);
    ASSERT_NEAR(warm.distance, cold.distance, 1e-12 * (20 + cold.distance));
    ASSERT_LE(warm.iterations, 10 * kMaxIterations);
  }
}

/// Faces parallel to each other: every normal but one gives less, and no single pair of points is the closest.
TEST(SuperellipsoidDistance, OfParallelFaces) {
  for (const double e : {0.2, 0.5, 0.8}) {
    const Superellipsoid box({1, 2, 3}, e, e);
    for (const Vector3d& shift : {Vector3d(2.5, 0, 0), Vector3d(2.5, 0.1, -0.2), Vector3d(0, 4 + 1e-7, 0.3)}) {
      const DistanceResult r = distance(box, Pose(), box, Pose::translation(shift));
      ASSERT_EQ(r.status, DistanceStatus::separated) << e;
      const double lower = geom_test::lower_bound(box, Pose(), box, Pose::translation(shift), r.normal);
      EXPECT_NEAR(r.distance, lower, 1e-12);
    }
    EXPECT_NEAR(distance(box, Pose(), box, Pose::translation({2.5, 0, 0})).distance, 0.5, 1e-15);
  }
}

/// Almost touching where a disk's side, on which the support point is lost to rounding of the normal, meets the rim of
/// another: the normal about the disk's axis and the points are as exact as where both are round.
TEST(SuperellipsoidDistance, OfAFlatSideAndARimHasTheNormalAndThePoints) {
  const Superellipsoid disk({1, 1, 0.5}, 0.4, 1);
  Random random(13);
  double worst_normal = 0, worst_point = 0;
  int most_iterations = 0;
  for (int k = 0; k < 2000; ++k) {
    const double z = random.log_uniform(1e-6, 1e-2);  // of the half thickness: the normal is z^4 off the plane
    const double rho = std::pow(1 - std::pow(z, 5), 0.2);
    const double phi = random.uniform(0, 6.28);
    const Vector3d at(rho * std::cos(phi), rho * std::sin(phi), 0.5 * z);
    const Vector3d n = Vector3d(std::cos(phi), std::sin(phi), 2 * std::pow(z / rho, 4)).normalized();
    const Eigen::Matrix3d R = random.pose(Vector3d(Vector3d::Zero())).rotation();
    const double gap = std::array{0.0, -1e-13, random.log_uniform(1e-12, 1e-9)}[static_cast<std::size_t>(k % 3)];
    const Pose X_WB(R, at + gap * n - R * disk.support(R.transpose() * -n).point);
    const Vector3d start = random.coin() ? Vector3d(Vector3d::Zero()) : Vector3d(n + 1e-3 * random.direction());
    const DistanceResult r = distance(disk, Pose(), disk, X_WB, {.start = start});
    ASSERT_NE(r.status, DistanceStatus::not_converged);
    ASSERT_NEAR(r.distance, gap, 1e-14) << "pair " << k;
    ASSERT_LE(r.error_bound, kBoundGap) << "pair " << k;
    most_iterations = std::max(most_iterations, r.iterations);
    worst_normal = std::max(worst_normal, (r.normal - n).norm());
    worst_point = std::max({worst_point, (r.point_a - at).norm(), (r.point_b - at - gap * n).norm()});
  }
  std::printf("normals within %.1e, points within %.1e, %d evaluations at most\n", worst_normal, worst_point,
              most_iterations);
  EXPECT_LE(most_iterations, 15);
  EXPECT_LE(worst_normal, 1e-12);
  EXPECT_LE(worst_point, 1e-12);
}

}  // namespace
}  // namespace geom
