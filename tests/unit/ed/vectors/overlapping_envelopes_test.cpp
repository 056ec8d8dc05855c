// Meetings of dilated envelopes found in vectors against may_overlap, pair by pair: the same bits.

#include "base/periodic.h"
#include "bodies/uniaxial.h"
#include "neighbours/dilated.h"
#include "vectors/choose.h"

#include <common/ed/states.h>
#include <common/ed/uniaxial_bodies.h>
#include <common/full_form.h>
#include <common/geom/batch.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ed::internal {
namespace {

/// All bodies, in the order of their numbers, as a cell grid of one cell finds them; centres that coincide among them.
std::vector<NearBody> all_near(const UniaxialBodies& bodies, int i, double box, Random& random) {
  std::vector<NearBody> near;
  for (int k = 0; k < bodies.number(); ++k) {
    const Eigen::Vector3d d = bodies.position_at(k, 0) - bodies.position_at(i, 0);
    near.push_back({k, random.uniform() < 0.01 ? Eigen::Vector3d(0, 0, 0) : nearest_image(d, box)});
  }
  return near;
}

struct Tally {
  std::size_t pairs = 0;
  std::size_t meetings = 0;
};

OverlapKernel* kernel_of(const UniaxialBodies& bodies, geom::InstructionSet set) {
  const UniaxialKernels found = find_uniaxial_kernels(set);
  if (bodies.all_spheres()) return found.spheres.overlap;
  return bodies.rods() ? found.rods.overlap : found.spheroids.overlap;
}

void expect_same_overlaps(const std::vector<Species>& species, geom::InstructionSet set, std::uint64_t seed,
                          Tally& tally) {
  SCOPED_TRACE(std::string(geom::to_string(set)) + ", seed " + std::to_string(seed));
  constexpr int kNumber = 150;  // more than a block
  Random random(seed);
  const double box = 8 + 16 * random.uniform();
  const UniaxialBodies bodies = ed_test::random_bodies(species, kNumber, box, random);
  const double thickness = random.uniform();
  DilatedEnvelopes one_by_one(bodies, thickness, thickness);
  DilatedEnvelopes in_vectors(bodies, thickness, thickness, kernel_of(bodies, set));
  for (int i = 0; i < kNumber; ++i) {
    one_by_one.place(i, bodies, 0);
    in_vectors.place(i, bodies, 0);
  }
  std::vector<OverlappingEnvelope> expected;
  std::vector<OverlappingEnvelope> found;
  for (int i = 0; i < kNumber; ++i) {
    const std::vector<NearBody> near = all_near(bodies, i, box, random);
    const int first = i % 2 == 0 ? 0 : i + 1;
    one_by_one.find_overlapping(i, near, first, expected);
    in_vectors.find_overlapping(i, near, first, found);
    ASSERT_EQ(found.size(), expected.size()) << i;
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].body, expected[k].body) << i;
      ed_test::expect_same_bits(found[k].normal, expected[k].normal);
    }
    tally.pairs += near.size();
    tally.meetings += found.size();
  }
}

void expect_same_overlaps(const std::vector<Species>& species) {
  const std::uint64_t repetitions = full_form() ? 100 : 10;
  for (const geom::InstructionSet set : geom_test::instruction_sets()) {
    Tally tally;
    for (std::uint64_t k = 0; k < repetitions; ++k) expect_same_overlaps(species, set, 500 + k, tally);
    EXPECT_GT(tally.meetings, tally.pairs / 200);
    EXPECT_LT(tally.meetings, tally.pairs / 2);
  }
}

TEST(Meetings, OfRodsAreThoseOfOnePair) {
  expect_same_overlaps({paper_species(ed_test::spheroid(3))});
}

TEST(Meetings, OfFlatDiscsAreThoseOfOnePair) {
  expect_same_overlaps({paper_species(ed_test::spheroid(0.15))});
}

TEST(Meetings, OfMixturesAreThoseOfOnePair) {
  expect_same_overlaps({uniform_species(ed_test::spheroid(8)), uniform_species(ed_test::spheroid(0.4)),
                        uniform_species(ed_test::spheroid(1))});
}

TEST(Meetings, OfCapsulesAndSpheresAreThoseOfOnePair) {
  expect_same_overlaps({uniform_species(geom::Capsule(2, 0.5))});
  expect_same_overlaps({uniform_species(geom::Capsule(2, 0.5)), uniform_species(geom::Capsule(0.1, 1)),
                        uniform_species(geom::Sphere(0.4))});
}

TEST(Meetings, OfSpheresAreThoseOfOnePair) {
  expect_same_overlaps({uniform_species(geom::Sphere(1))});
  expect_same_overlaps({uniform_species(geom::Sphere(1.5)), uniform_species(geom::Sphere(0.4))});
}

}  // namespace
}  // namespace ed::internal
