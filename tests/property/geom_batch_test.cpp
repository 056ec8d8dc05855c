/// distance_batch() against distance() and against manufactured answers, for every instruction set of the processor.
/// HARDBODY_FULL=1: ten million pairs instead of a hundred thousand.

#include "common/finder/scale.h"
#include "common/geom/batch.h"
#include "common/geom/manufactured.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace geom {
namespace {

using geom_test::answers;
using geom_test::distance_tolerance;
using geom_test::instruction_sets;
using geom_test::ManufacturedPair;
using geom_test::normal_tolerance;
using geom_test::Pairs;
using geom_test::Random;
using geom_test::same_answer;

enum class Kind { uniaxial, biaxial, mixed };

struct Population {
  const char* name;
  Kind kind;
  double ratio;  ///< largest ratio of semi-axes
  std::uint64_t seed;
  double most_redone;  ///< share of the pairs that may be left to distance()
};

std::ostream& operator<<(std::ostream& out, const Population& population) {
  return out << population.name;
}

Ellipsoid random_shape(const Population& population, Random& random) {
  const bool uniaxial = population.kind == Kind::uniaxial || (population.kind == Kind::mixed && random.coin());
  return uniaxial ? random.spheroid(random.log_uniform(1 / population.ratio, population.ratio))
                  : random.biaxial(population.ratio);
}

/// Two thirds apart by 1e-10 to 10, the others overlapping by 1e-8 to 0.99 of the certified depth.
double random_distance(const Ellipsoid& a, const Ellipsoid& b, Random& random) {
  if (random.uniform() < 2.0 / 3) return random.log_uniform(1e-10, 10);
  return -random.log_uniform(1e-8, 0.99) * (a.min_curvature_radius() + b.min_curvature_radius());
}

class ManufacturedBatch : public testing::TestWithParam<Population> {};

TEST_P(ManufacturedBatch, IsAnsweredAsByDistance) {
  const Population& population = GetParam();
  const int wanted = finder_test::scaled(20'000, 2'000'000);  // five populations
  constexpr int kMostPairs = 1000;
  Random random(population.seed);
  double worst = 0;
  std::size_t redone = 0;
  std::size_t asked = 0;
  for (int done = 0; done < wanted;) {
    Pairs pairs;
    std::vector<ManufacturedPair> known;
    const int count = std::min(wanted - done, 1 + static_cast<int>(kMostPairs * random.uniform()));
    for (int i = 0; i < count; ++i) {
      const Ellipsoid a = random_shape(population, random);
      const Ellipsoid b = random_shape(population, random);
      known.push_back(geom_test::manufacture(a, b, random_distance(a, b, random), random));
      pairs.add(a, known.back().X_WA, b, known.back().X_WB);
    }
    std::vector<DistanceResult> scalar;
    for (std::size_t i = 0; i < pairs.size(); ++i) scalar.push_back(pairs.distance(i));
    std::vector<DistanceResult> results(pairs.size());
    for (const InstructionSet set : instruction_sets()) {
      redone += distance_batch(pairs.a, pairs.X_WA, pairs.b, pairs.X_WB, results, {.instruction_set = set}).redone;
      asked += pairs.size();
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        const double scale = pairs.scale(i);
        const double extent = pairs.extent(i);
        const auto where = [&] { return std::string(to_string(set)) + ", pair " + std::to_string(done + int(i)); };
        ASSERT_TRUE(same_answer(results[i], scalar[i], scale, extent)) << where();
        ASSERT_TRUE(answers(results[i], known[i].distance, distance_tolerance(scale), extent)) << where();
        ASSERT_LE((results[i].normal - known[i].normal).norm(),
                  normal_tolerance(pairs.a[i], pairs.b[i], known[i].distance, scale))
            << where();
        worst = std::max(worst, std::abs(results[i].distance - scalar[i].distance) / scale);
      }
    }
    done += count;
  }
  const double share = static_cast<double>(redone) / static_cast<double>(asked);
  std::printf("%s: %d pairs, distances differ by %.1e of the size at most, %.4f %% left to distance()\n",
              population.name, wanted, worst, 100 * share);
  EXPECT_LE(share, population.most_redone);
}

INSTANTIATE_TEST_SUITE_P(Populations, ManufacturedBatch,
                         testing::Values(Population{"Uniaxial", Kind::uniaxial, 10, 301, 0.001},
                                         Population{"Biaxial", Kind::biaxial, 10, 302, 0.001},
                                         Population{"Mixed", Kind::mixed, 10, 303, 0.001},
                                         Population{"NearlySpherical", Kind::mixed, 1.01, 304, 0.01},
                                         Population{"MixedExtreme", Kind::mixed, 1000, 305, 0.1}),
                         [](const auto& instance) { return instance.param.name; });

TEST(DistanceBatch, AnswersRandomPlacementsAsDistance) {
  // Overlaps of any depth among them: what is deeper than certified must come out as distance() decides.
  Random random(306);
  Pairs pairs;
  const Population population{"", Kind::mixed, 5, 0, 0};
  for (int i = 0; i < finder_test::scaled(5'000, 50'000); ++i) {
    const Ellipsoid a = random_shape(population, random);
    const Ellipsoid b = random_shape(population, random);
    const double radii = a.bounding_radius() + b.bounding_radius();
    pairs.add(a, random.pose(0.7 * radii), b, random.pose(0.7 * radii));
  }
  std::vector<DistanceResult> scalar;
  for (std::size_t i = 0; i < pairs.size(); ++i) scalar.push_back(pairs.distance(i));
  for (const InstructionSet set : instruction_sets()) {
    const std::vector<DistanceResult> results = pairs.distance_batch({.instruction_set = set});
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      ASSERT_TRUE(same_answer(results[i], scalar[i], pairs.scale(i), pairs.extent(i)))
          << to_string(set) << ", pair " << i;
    }
  }
}

}  // namespace
}  // namespace geom
