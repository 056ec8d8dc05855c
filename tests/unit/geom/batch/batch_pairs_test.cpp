/// distance_batch() of pairs by reference.

#include "common/geom/manufactured.h"
#include "common/message_of.h"

#include <geom/geom.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace geom {
namespace {

using geom_test::Random;

/// Bodies and pairs of them, those far apart and those that overlap among them.
struct PairsOfBodies {
  std::vector<Ellipsoid> shapes;
  std::vector<Pose> poses;
  std::vector<EllipsoidPair> pairs;
};

PairsOfBodies random_pairs_of_bodies(std::size_t bodies, std::size_t pairs) {
  Random random(21);
  PairsOfBodies made;
  for (std::size_t i = 0; i < bodies; ++i) {
    made.shapes.push_back(random.coin() ? random.spheroid(3) : random.biaxial(5));
    made.poses.push_back(random.pose(4.0));
  }
  for (std::size_t k = 0; k < pairs; ++k) {
    const std::size_t a = k % bodies, b = (7 * k + 1) % bodies;
    made.pairs.push_back({&made.shapes[a], &made.poses[a], &made.shapes[b], &made.poses[b]});
  }
  return made;
}

TEST(DistanceBatch, OfPairsByReferenceGivesTheSameBitsAsOfSpans) {
  const PairsOfBodies bodies = random_pairs_of_bodies(50, 333);
  std::vector<Ellipsoid> a, b;
  std::vector<Pose> X_WA, X_WB;
  std::vector<Eigen::Vector3d> starts;
  for (const EllipsoidPair& pair : bodies.pairs) {
    a.push_back(*pair.a);
    b.push_back(*pair.b);
    X_WA.push_back(*pair.X_WA);
    X_WB.push_back(*pair.X_WB);
    starts.push_back(pair.X_WB->position() - pair.X_WA->position());
  }
  for (const bool is_warm : {false, true}) {
    BatchOptions options;
    if (is_warm) options.starts = starts;
    std::vector<DistanceResult> of_spans(a.size()), of_pairs(a.size());
    const BatchSummary summary = distance_batch(a, X_WA, b, X_WB, of_spans, options);
    EXPECT_EQ(distance_batch(bodies.pairs, of_pairs, options).redone, summary.redone);
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(of_pairs[k].status, of_spans[k].status) << k;
      EXPECT_EQ(of_pairs[k].iterations, of_spans[k].iterations) << k;
      if (of_spans[k].status == DistanceStatus::not_converged) continue;
      EXPECT_EQ(of_pairs[k].distance, of_spans[k].distance) << k;
      EXPECT_EQ(of_pairs[k].normal, of_spans[k].normal) << k;
      EXPECT_EQ(of_pairs[k].point_a, of_spans[k].point_a) << k;
      EXPECT_EQ(of_pairs[k].error_bound, of_spans[k].error_bound) << k;
    }
  }
}

TEST(DistanceBatch, OfPairsByReferenceRefusesAnotherNumberOfResults) {
  const PairsOfBodies bodies = random_pairs_of_bodies(2, 3);
  std::vector<DistanceResult> results(2);
  EXPECT_THAT(test_common::message_of([&] { distance_batch(bodies.pairs, results); }),
              testing::AllOf(testing::HasSubstr("pairs has 3"), testing::HasSubstr("which has 2")));
}

}  // namespace
}  // namespace geom
