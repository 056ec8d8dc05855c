/// distance_batch(): sizes of the spans, starts, instruction sets, and the cases that the kernels leave to distance().

#include "common/geom/batch.h"
#include "common/geom/manufactured.h"
#include "common/message_of.h"
#include "common/special_values.h"

#include <geom/geom.h>
#include <geom/kernel/any_body.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <variant>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::declined;
using geom_test::instruction_sets;
using geom_test::ManufacturedPair;
using geom_test::Pairs;
using geom_test::Random;
using geom_test::same_answer;
using test_common::message_of;

constexpr std::span<const Ellipsoid> kNoBodies;

/// Bodies of revolution and general ones, apart and overlapping, in no order.
Pairs mixed_pairs(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  const auto shape = [&] { return random.coin() ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10); };
  Pairs pairs;
  while (pairs.size() < count) {
    const Ellipsoid a = shape();
    const Ellipsoid b = shape();
    const double depth = a.min_curvature_radius() + b.min_curvature_radius();
    const double distance = random.coin() ? random.log_uniform(1e-6, 10) : -0.9 * depth * random.uniform();
    const ManufacturedPair pair = geom_test::manufacture(a, b, distance, random);
    pairs.add(a, pair.X_WA, b, pair.X_WB);
  }
  return pairs;
}

void expect_same_as_distance(const Pairs& pairs, InstructionSet set) {
  const std::vector<DistanceResult> results = pairs.distance_batch({.instruction_set = set});
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_TRUE(same_answer(results[i], pairs.distance(i), pairs.scale(i), pairs.extent(i)))
        << to_string(set) << ", pair " << i << " of " << pairs.size();
  }
}

bool same_bits(const DistanceResult& r, const DistanceResult& s) {
  return r.distance == s.distance && r.point_a == s.point_a && r.point_b == s.point_b && r.normal == s.normal &&
         r.status == s.status && r.iterations == s.iterations && r.residual == s.residual &&
         r.error_bound == s.error_bound;
}

TEST(DistanceBatch, AnswersAsDistanceWhateverTheNumberOfPairs) {
  for (const InstructionSet set : instruction_sets()) {
    for (const std::size_t count : {1, 2, 3, 7, 8, 9, 31, 32, 33, 63, 65, 100, 257}) {
      expect_same_as_distance(mixed_pairs(count, 10 + count), set);
    }
  }
}

TEST(DistanceBatch, OfNoPairsIsNothing) {
  const BatchSummary none = distance_batch(kNoBodies, {}, kNoBodies, {}, {});
  EXPECT_EQ(none.redone, 0u);
  const Pairs one = mixed_pairs(1, 1);
  EXPECT_NO_THROW(distance_batch(one.a, one.X_WA, one.b, one.X_WB, {}));
}

TEST(DistanceBatch, RefusesSpansOfOtherSizes) {
  const Pairs pairs = mixed_pairs(5, 2);
  const Pairs fewer = mixed_pairs(4, 3);
  std::vector<DistanceResult> results(5);
  const std::vector<Vector3d> starts(3, Vector3d::UnitX());
  EXPECT_THAT(message_of([&] { distance_batch(fewer.a, pairs.X_WA, pairs.b, pairs.X_WB, results); }),
              testing::AllOf(testing::HasSubstr("a has 4"), testing::HasSubstr("which has 5")));
  EXPECT_THAT(message_of([&] { distance_batch(pairs.a, fewer.X_WA, pairs.b, pairs.X_WB, results); }),
              testing::HasSubstr("X_WA has 4"));
  EXPECT_THAT(message_of([&] { distance_batch(pairs.a, pairs.X_WA, {}, pairs.X_WB, results); }),
              testing::HasSubstr("b has 0"));
  EXPECT_THAT(message_of([&] { distance_batch(pairs.a, pairs.X_WA, pairs.b, fewer.X_WB, results); }),
              testing::HasSubstr("X_WB has 4"));
  EXPECT_THAT(
      message_of([&] { distance_batch(pairs.a, pairs.X_WA, pairs.b, pairs.X_WB, results, {.starts = starts}); }),
      testing::HasSubstr("starts has 3"));
  EXPECT_TRUE(declined(results.front())) << "nothing is written before the input is checked";
}

TEST(DistanceBatch, TakesOneElementForAllPairs) {
  Random random(4);
  const Ellipsoid needle({1, 1, 5});
  const Ellipsoid disc({2, 2.5, 0.3});
  const Pose X_WA = random.pose(1.0);
  std::vector<Pose> X_WB;
  Pairs pairs;
  for (int i = 0; i < 77; ++i) {
    X_WB.push_back(random.pose(10.0));
    pairs.add(needle, X_WA, disc, X_WB.back());
  }
  std::vector<DistanceResult> results(X_WB.size());
  distance_batch({&needle, 1}, {&X_WA, 1}, {&disc, 1}, X_WB, results);
  const std::vector<DistanceResult> written_out = pairs.distance_batch();
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].status, written_out[i].status) << i;
    if (results[i].status == DistanceStatus::not_converged) continue;
    EXPECT_TRUE(same_bits(results[i], written_out[i])) << i;
  }
}

TEST(DistanceBatch, APairsAnswerDoesNotDependOnItsCompanions) {
  const Pairs pairs = mixed_pairs(100, 5);
  for (const InstructionSet set : instruction_sets()) {
    const std::vector<DistanceResult> together = pairs.distance_batch({.instruction_set = set});
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      Pairs alone;
      alone.add(pairs.a[i], pairs.X_WA[i], pairs.b[i], pairs.X_WB[i]);
      EXPECT_TRUE(same_bits(alone.distance_batch({.instruction_set = set})[0], together[i]))
          << to_string(set) << ", pair " << i;
    }
  }
}

TEST(DistanceBatch, StartsFromGivenNormals) {
  const Pairs pairs = mixed_pairs(200, 6);
  for (const InstructionSet set : instruction_sets()) {
    const std::vector<DistanceResult> cold = pairs.distance_batch({.instruction_set = set});
    std::vector<Vector3d> starts;
    for (const DistanceResult& r : cold) starts.push_back(3 * r.normal);  // any length
    const std::vector<DistanceResult> warm = pairs.distance_batch({.starts = starts, .instruction_set = set});
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_TRUE(same_answer(warm[i], cold[i], pairs.scale(i), pairs.extent(i))) << to_string(set) << ", pair " << i;
      EXPECT_LE(warm[i].iterations, 2) << "pair " << i;
    }
  }
}

TEST(DistanceBatch, StartsColdWhereAStartIsNoDirection) {
  const Pairs pairs = mixed_pairs(16, 7);
  const std::array starts{Vector3d(0, 0, 0), Vector3d(kNaN, 0, 0), Vector3d(kInfinity, 1, 0), Vector3d(0, 1e-200, 0)};
  std::vector<Vector3d> given;
  for (std::size_t i = 0; i < pairs.size(); ++i) given.push_back(starts[i % starts.size()]);
  for (const InstructionSet set : instruction_sets()) {
    const std::vector<DistanceResult> cold = pairs.distance_batch({.instruction_set = set});
    const std::vector<DistanceResult> warm = pairs.distance_batch({.starts = given, .instruction_set = set});
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_TRUE(same_bits(warm[i], cold[i])) << to_string(set) << ", pair " << i;
    }
  }
}

TEST(DistanceBatch, DoesNotBelieveAnOverlapFoundFromAMisleadingStart) {
  // Two discs apart, started with the normals that are worst: along the other body's rim, and backwards.
  Random random(8);
  const Ellipsoid disc({1, 1, 0.05});
  Pairs pairs;
  std::vector<Vector3d> starts;
  for (int i = 0; i < 200; ++i) {
    const ManufacturedPair pair = geom_test::manufacture(disc, disc, random.log_uniform(1e-6, 1), random);
    pairs.add(disc, pair.X_WA, disc, pair.X_WB);
    starts.push_back(random.coin() ? Vector3d(-pair.normal) : random.direction());
  }
  for (const InstructionSet set : instruction_sets()) {
    const std::vector<DistanceResult> warm = pairs.distance_batch({.starts = starts, .instruction_set = set});
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_TRUE(same_answer(warm[i], pairs.distance(i), pairs.scale(i), pairs.extent(i)))
          << to_string(set) << ", pair " << i;
    }
  }
}

TEST(DistanceBatch, AnswersTinyAndHugeBodies) {
  Random random(9);
  for (const double unit : {1e-49, 1e-30, 1e-12, 1e-3, 1e3, 1e12, 1e30, 1e48}) {
    Pairs pairs;
    for (int i = 0; i < 20; ++i) {
      const bool general = random.coin();
      const Ellipsoid a(unit * (general ? Vector3d(1, 2, 3) : Vector3d(2, 2, 0.5)));
      const Ellipsoid b(unit * (general ? Vector3d(0.3, 2, 1) : Vector3d(1, 1, 4)));
      const ManufacturedPair pair = geom_test::manufacture(a, b, unit * random.log_uniform(1e-6, 10), random);
      pairs.add(a, pair.X_WA, b, pair.X_WB);
    }
    for (const InstructionSet set : instruction_sets()) expect_same_as_distance(pairs, set);
  }
}

TEST(DistanceBatch, AnswersNeedlesAndDiscsBesideSmallBodies) {
  Random random(11);
  Pairs pairs;
  for (int i = 0; i < 400; ++i) {
    const double ratio = random.log_uniform(10, 9e3);
    const Vector3d axes = random.coin() ? Vector3d(1, 1, ratio) : Vector3d(ratio, 0.9 * ratio, 1);
    const Ellipsoid a(axes);
    const Ellipsoid b(random.log_uniform(1e-3, 1) * Vector3d(1, 1.2, 1));
    const ManufacturedPair pair = geom_test::manufacture(a, b, random.log_uniform(1e-3, 1), random);
    pairs.add(a, pair.X_WA, b, pair.X_WB);
  }
  for (const InstructionSet set : instruction_sets()) expect_same_as_distance(pairs, set);
}

TEST(DistanceBatch, AnswersConcentricBodiesAsDistance) {
  Pairs pairs;
  const Pose X = Pose::translation({1, 2, 3});
  const Pose X_turned = Pose::from_quaternion(std::sqrt(0.5), 0, std::sqrt(0.5), 0, {1, 2, 3});
  for (const Pose& other : {X, X_turned}) {
    pairs.add(Ellipsoid({1, 1, 1}), X, Ellipsoid({2, 2, 2}), other);
    pairs.add(Ellipsoid({1, 1, 3}), X, Ellipsoid({1, 1, 3}), other);
    pairs.add(Ellipsoid({1, 2, 3}), X, Ellipsoid({0.5, 1, 0.1}), other);
  }
  for (const InstructionSet set : instruction_sets()) {
    const std::vector<DistanceResult> results = pairs.distance_batch({.instruction_set = set});
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const DistanceResult scalar = pairs.distance(i);
      EXPECT_EQ(results[i].status, scalar.status) << to_string(set) << ", pair " << i;
      if (scalar.status == DistanceStatus::not_converged) continue;
      EXPECT_NEAR(results[i].distance, scalar.distance, 1e-14 * pairs.scale(i)) << to_string(set) << ", pair " << i;
    }
  }
}

TEST(DistanceBatch, LeavesToDistanceWhatOverflows) {
  Pairs pairs = mixed_pairs(20, 12);
  for (std::size_t i = 0; i < pairs.size(); i += 3) pairs.X_WB[i] = Pose::translation({1e100, -1e100, 1e90});
  for (const InstructionSet set : instruction_sets()) {
    const std::vector<DistanceResult> results = pairs.distance_batch({.instruction_set = set});
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_EQ(results[i].status, pairs.distance(i).status) << to_string(set) << ", pair " << i;
    }
  }
}

TEST(DistanceBatch, CountsThePairsGivenToDistance) {
  Random random(13);
  Pairs pairs = mixed_pairs(100, 14);
  std::vector<DistanceResult> results(pairs.size());
  EXPECT_LE(distance_batch(pairs.a, pairs.X_WA, pairs.b, pairs.X_WB, results).redone, 5u);
  // Deeper than is certified: needles through each other.
  const Ellipsoid needle({1, 1, 10});
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs.X_WB[i] = Pose(random.pose(0.0).rotation(), Vector3d(0.5, 0, 0));
  const Pose X_WA;
  EXPECT_GE(distance_batch({&needle, 1}, {&X_WA, 1}, {&needle, 1}, pairs.X_WB, results).redone, 95u);
}

/// Needles through each other: deeper than the kernels certify.
Pairs deep_pairs(std::size_t count) {
  Random random(15);
  const Ellipsoid needle({1, 1, 10});
  Pairs pairs;
  while (pairs.size() < count)
    pairs.add(needle, Pose(), needle, Pose(random.pose(0.0).rotation(), Vector3d(0.5, 0, 0)));
  return pairs;
}

TEST(DistanceBatch, AsksForTheLocalPenetrationWhereTheOptionsDo) {
  const Pairs pairs = deep_pairs(100);
  const DistanceOptions local{.penetration = Penetration::local};
  for (const InstructionSet set : instruction_sets()) {
    const auto results = pairs.distance_batch({.instruction_set = set, .penetration = Penetration::local});
    int uncertified = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const DistanceResult one = pairs.distance(i, local);
      EXPECT_TRUE(same_bits(results[i], one)) << to_string(set) << ", pair " << i;
      uncertified += std::isinf(one.error_bound) ? 1 : 0;
    }
    EXPECT_GE(uncertified, 90) << "of 100 that no search over all normals was spent on";
  }
}

TEST(DistanceBatch, LeavesToDistanceWhatTakesMoreIterationsThanTheOptionsAllow) {
  const Pairs pairs = mixed_pairs(100, 16);
  for (const InstructionSet set : instruction_sets()) {
    const auto unlimited = pairs.distance_batch({.instruction_set = set});
    for (const int limit : {0, 1, 3, kMaxIterations}) {
      const auto results = pairs.distance_batch({.instruction_set = set, .max_iterations = limit});
      int limited = 0;
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        const DistanceResult one = pairs.distance(i, {.max_iterations = limit});
        EXPECT_TRUE(same_answer(results[i], one, pairs.scale(i), pairs.extent(i))) << to_string(set) << ", pair " << i;
        // A cold start of the kernels is another than that of `distance`: so is what a pair takes.
        if (unlimited[i].iterations > std::max(1, limit)) {
          EXPECT_TRUE(same_bits(results[i], one)) << to_string(set) << ", pair " << i;
          EXPECT_EQ(results[i].iterations, one.iterations) << to_string(set) << ", pair " << i;
          ++limited;
        } else {
          EXPECT_TRUE(same_bits(results[i], unlimited[i])) << to_string(set) << ", pair " << i;
        }
      }
      EXPECT_EQ(limited > 50, limit <= 3) << limited << " of 100 within " << limit;
    }
  }
}

TEST(DistanceBatch, OfShapesPassesItsOptionsOn) {
  const Pairs pairs = deep_pairs(20);
  std::vector<Shape> a, b;
  std::vector<Pose> X_WB;
  const Superellipsoid bar({1, 1, 10}, 0.7, 0.8);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (const Shape& shape : {Shape(pairs.a[i]), Shape(bar)}) {
      a.push_back(shape);
      b.push_back(shape);
      X_WB.push_back(pairs.X_WB[i]);
    }
  }
  std::vector<DistanceResult> results(a.size());
  const Pose X_WA;
  distance_batch(a, {&X_WA, 1}, b, X_WB, results, {.max_iterations = 20, .penetration = Penetration::local});
  int uncertified = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const DistanceResult one =
        distance(a[i], X_WA, b[i], X_WB[i], {.max_iterations = 20, .penetration = Penetration::local});
    EXPECT_TRUE(same_bits(results[i], one)) << i;
    uncertified += std::isinf(one.error_bound) ? 1 : 0;
  }
  EXPECT_GE(uncertified, 36) << "of 40";
}

TEST(DistanceBatch, UsesTheInstructionSetThatItSays) {
  EXPECT_TRUE(is_available(InstructionSet::best));
  EXPECT_TRUE(is_available(InstructionSet::portable));
  EXPECT_TRUE(is_available(batch_instruction_set()));
  EXPECT_NE(batch_instruction_set(), InstructionSet::best);
  EXPECT_EQ(instruction_sets().back(), batch_instruction_set());
  EXPECT_EQ(distance_batch(kNoBodies, {}, kNoBodies, {}, {}).instruction_set, batch_instruction_set());
  for (const InstructionSet set : instruction_sets()) {
    EXPECT_EQ(distance_batch(kNoBodies, {}, kNoBodies, {}, {}, {.instruction_set = set}).instruction_set, set);
  }
}

TEST(DistanceBatch, RefusesInstructionSetsThatAreNotThere) {
  for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512, static_cast<InstructionSet>(99)}) {
    if (is_available(set)) continue;
    EXPECT_THAT(message_of([&] { distance_batch(kNoBodies, {}, kNoBodies, {}, {}, {.instruction_set = set}); }),
                testing::AllOf(testing::HasSubstr(to_string(set)), testing::HasSubstr("accepted: best, portable")));
  }
}

TEST(DistanceBatch, OfShapesAnswersAsDistance) {
  Random random(31);
  std::vector<Shape> a, b;
  std::vector<Pose> X_WA, X_WB;
  std::vector<Vector3d> starts;
  std::size_t superellipsoids = 0;
  for (int k = 0; k < 500; ++k) {
    const auto shape = [&](bool round) -> Shape {
      const Vector3d axes = random.biaxial(3).semi_axes();
      if (round) return random.coin() ? Shape(Ellipsoid(axes)) : Shape(Superellipsoid(axes, 1, 1));
      return Superellipsoid(axes, 0.5, 1.2);
    };
    const bool round = k % 3 != 0;
    superellipsoids += round ? 0 : 1;
    a.push_back(shape(true));
    b.push_back(shape(round));
    const ManufacturedPair pair = kernel::with_bodies(a.back(), b.back(), [&](const auto& s, const auto& t) {
      return geom_test::manufacture(s, t, random.log_uniform(1e-3, 1), random);
    });
    X_WA.push_back(pair.X_WA);
    X_WB.push_back(pair.X_WB);
    starts.emplace_back(pair.normal + 0.1 * random.direction());
  }
  for (const bool warm : {false, true}) {
    std::vector<DistanceResult> results(a.size());
    BatchOptions options;
    if (warm) options.starts = starts;
    const BatchSummary summary = distance_batch(a, X_WA, b, X_WB, results, options);
    EXPECT_GE(summary.redone, superellipsoids);
    EXPECT_LE(summary.redone, superellipsoids + 20);
    for (std::size_t k = 0; k < a.size(); ++k) {
      const DistanceResult one = distance(a[k], X_WA[k], b[k], X_WB[k], {.start = warm ? starts[k] : Vector3d::Zero()});
      const double size =
          (X_WB[k].position() - X_WA[k].position()).norm() + bounding_radius(a[k]) + bounding_radius(b[k]);
      EXPECT_EQ(results[k].status, one.status) << k;
      EXPECT_NEAR(results[k].distance, one.distance, 1e-14 * size) << k;
      EXPECT_NEAR((results[k].point_a - one.point_a).norm(), 0, 1e-7) << k;
    }
  }
}

TEST(DistanceBatch, OfShapesRefusesSpansOfOtherSizes) {
  const std::vector<Shape> shapes(3, Shape(Ellipsoid({1, 1, 2})));
  const std::vector<Pose> poses(2);
  std::vector<DistanceResult> results(3);
  EXPECT_THAT(message_of([&] { distance_batch(shapes, poses, shapes, poses, results); }),
              testing::StartsWith("distance_batch: X_WA has 2 elements; accepted: "));
}

}  // namespace
}  // namespace geom
