// Distances of superellipsoids whose answer is known before it is computed: B is placed so that the support points of a
// chosen normal are the witness points. Five ways to choose it, three of them where flat faces, edges and vertices make
// it hard. HARDBODY_FULL=1: 100,000 pairs a cell and class instead of 500.

#include "common/geom_manufactured.h"
#include "common/geom_random.h"
#include "common/geom_superellipsoid_sets.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::choose;
using geom_test::kExponents;
using geom_test::Orientation;
using geom_test::PairSet;
using geom_test::place;
using geom_test::Random;

struct SetTraits {
  PairSet set;
  const char* name;
  double tolerance;  ///< of the distance, relative to the size of the pair
  double declined;   ///< share that may be declined
};

constexpr std::array<SetTraits, 5> kSets{{{PairSet::random_normal, "random normal", 1e-12, 0},
                                          {PairSet::random_point, "random point", 1e-12, 0},
                                          {PairSet::aligned, "aligned copies", 1e-12, 0},
                                          {PairSet::edges, "edges and vertices", 5e-10, 0},
                                          {PairSet::faces, "faces", 5e-10, 0}}};

struct Tally {
  long pairs = 0;
  long wrong = 0;
  long declined = 0;
  double worst = 0;
};

void try_pair(const Superellipsoid& shape, const SetTraits& traits, Random& random, Tally& tally) {
  const Orientation o = choose(traits.set, shape, random);
  const double gap = random.log_uniform(1e-8, 1);
  Pose X_WA, X_WB;
  place(o, shape, gap, X_WA, X_WB);
  // What rounding has left of the gap: g at the chosen normal.
  const double wanted = geom_test::lower_bound(shape, X_WA, shape, X_WB, o.n);
  const DistanceResult r = distance(shape, X_WA, shape, X_WB);
  ++tally.pairs;
  if (r.status == DistanceStatus::not_converged) {
    ++tally.declined;
    return;
  }
  const double error = std::abs(r.distance - wanted) / (X_WB.position().norm() + 2 * shape.bounding_radius());
  tally.worst = std::max(tally.worst, error);
  if (!(error <= traits.tolerance)) ++tally.wrong;
  ASSERT_NEAR((r.point_b - r.point_a - r.distance * r.normal).norm(), 0, 1e-14);
}

TEST(SuperellipsoidDistance, OfKnownAnswers) {
  const long pairs = std::getenv("HARDBODY_FULL") != nullptr ? 100000 : 500;
  for (const SetTraits& traits : kSets) {
    Tally all;
    for (const double e1 : kExponents) {
      for (const double e2 : kExponents) {
        Random random(static_cast<unsigned>(1000 * e1 + 10 * e2) + static_cast<unsigned>(traits.set));
        Tally cell;
        for (long k = 0; k < pairs; ++k) {
          const Vector3d axes =
              k % 3 == 0
                  ? Vector3d(1, 1, 1)
                  : (k % 3 == 1 ? Vector3d(1, 1, 2) : Vector3d(1, random.uniform(0.6, 1.6), random.uniform(0.4, 2.4)));
          try_pair(Superellipsoid(axes, e1, e2), traits, random, cell);
        }
        EXPECT_EQ(cell.wrong, 0) << traits.name << ", e1 = " << e1 << ", e2 = " << e2;
        EXPECT_LE(static_cast<double>(cell.declined), traits.declined * static_cast<double>(pairs))
            << traits.name << ", e1 = " << e1 << ", e2 = " << e2;
        all.pairs += cell.pairs;
        all.declined += cell.declined;
        all.worst = std::max(all.worst, cell.worst);
      }
    }
    std::printf("%-20s %ld pairs, %ld declined, largest error %.1e of the size\n", traits.name, all.pairs, all.declined,
                all.worst);
  }
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

/// Bodies pushed into each other along a known normal: the depth is that of the push, or less where a shorter way out
/// exists, which is to be found on faces and edges only.
TEST(SuperellipsoidDistance, OfOverlaps) {
  const long pairs = std::getenv("HARDBODY_FULL") != nullptr ? 20000 : 30;
  for (const SetTraits& traits : kSets) {
    Tally all;
    long shorter = 0;
    for (const double e1 : kExponents) {
      for (const double e2 : kExponents) {
        Random random(static_cast<unsigned>(1000 * e1 + 10 * e2) + static_cast<unsigned>(traits.set));
        for (long k = 0; k < pairs; ++k) {
          const Superellipsoid shape({1, random.uniform(0.6, 1.6), random.uniform(0.4, 2.4)}, e1, e2);
          const Orientation o = choose(traits.set, shape, random);
          const double depth = random.log_uniform(1e-8, 1e-3);
          Pose X_WA, X_WB;
          place(o, shape, -depth, X_WA, X_WB);
          const double wanted = geom_test::lower_bound(shape, X_WA, shape, X_WB, o.n);
          const DistanceResult r = distance(shape, X_WA, shape, X_WB);
          const double size = X_WB.position().norm() + 2 * shape.bounding_radius();
          ++all.pairs;
          if (r.status == DistanceStatus::not_converged) {
            ++all.declined;
            continue;
          }
          const double better = (r.distance - wanted) / size;
          all.worst = std::max(all.worst, -better);
          if (better < -traits.tolerance) ++all.wrong;
          if (better > 1e-12) {
            ++shorter;
            EXPECT_NEAR(geom_test::lower_bound(shape, X_WA, shape, X_WB, r.normal), r.distance, 1e-14 * size);
          }
        }
      }
    }
    std::printf(
        "%-20s %ld overlaps, %ld declined, %ld deeper than known (by up to %.1e of the size), %ld have a shorter "
        "way out than the push\n",
        traits.name, all.pairs, all.declined, all.wrong, all.worst, shorter);
    EXPECT_EQ(all.wrong + all.declined, 0) << traits.name;
  }
}

TEST(SuperellipsoidDistance, OfConcentricBoxes) {
  const Superellipsoid box({1, 2, 3}, 0.5, 0.5);
  EXPECT_NEAR(distance(box, Pose(), box, Pose()).distance, -2, 1e-14);
  EXPECT_NEAR(distance(box, Pose(), box, Pose::translation({0.5, 0, 0})).distance, -1.5, 1e-14);
  // Local: from a start along z, the way out along z.
  const DistanceResult local = distance(box, Pose(), box, Pose::translation({0, 0, 0.5}),
                                        {.start = {0, 0, 1}, .penetration = Penetration::local});
  EXPECT_EQ(local.status, DistanceStatus::overlapping);
  EXPECT_NEAR(local.distance, -5.5, 1e-14);
}

}  // namespace
}  // namespace geom
