// First looks in vectors against certified_contact, pair by pair: the same bits, the same counters.

#include "bodies/first_looks.h"
#include "base/periodic.h"
#include "bodies/uniaxial.h"
#include "loop/factory.h"

#include <common/ed/states.h>
#include <common/ed/uniaxial_bodies.h>
#include <common/full_form.h>
#include <common/geom/batch.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace ed::internal {
namespace {

using ed_test::bits;
using ed_test::expect_same_bits;
using ed_test::random_bodies;
using Eigen::Vector3d;

/// All pairs, the normals of some converged, of some a little off, of some far off or zero.
std::vector<Pair> random_pairs(const UniaxialBodies& bodies, double now, double box, Random& random) {
  std::vector<Pair> pairs;
  for (int i = 0; i < bodies.number(); ++i) {
    for (int j = 0; j < bodies.number(); ++j) {
      if (i == j) continue;
      Pair pair;
      pair.i = i;
      pair.j = j;
      const Vector3d r = nearest_image(bodies.position_at(j, now) - bodies.position_at(i, now), box);
      pair.normal = r.normalized();
      FinderCounters count;
      std::optional<Unsolved> unsolved;
      if (random.uniform() < 0.8) bodies.find_contact(i, j, r, now, now + 1, 4, {}, pair.normal, count, unsolved);
      const double off = random.uniform();
      if (off < 0.6) pair.normal = (pair.normal + 0.3 * off * off * off * random.normal3()).normalized();
      if (off > 0.98) pair.normal = Vector3d::Zero();
      if (off > 0.96 && off < 0.98) pair.normal = random.direction();
      pairs.push_back(pair);
    }
  }
  return pairs;
}

/// Answered looks: their share, and the contacts among them.
struct Answers {
  double share;
  int contacts;
};

Answers expect_same_looks(const std::vector<Species>& species, geom::InstructionSet set, std::uint64_t seed) {
  SCOPED_TRACE(std::string(geom::to_string(set)) + ", seed " + std::to_string(seed));
  constexpr int kNumber = 40;
  Random random(seed);
  const double box = 8 + 8 * random.uniform();
  const double now = 0.4 + 0.2 * random.uniform();
  const UniaxialBodies bodies = random_bodies(species, kNumber, box, random);
  std::vector<Pair> pairs = random_pairs(bodies, now, box, random);
  std::vector<Pair> scalar = pairs;
  std::vector<PairLook> looks;
  for (Pair& pair : pairs) looks.push_back({&pair, now + std::exp(3 * random.uniform() - 4)});
  SimulationOptions options;
  options.batches = set;
  const auto batch = make_first_looks(bodies, options);
  FinderCounters count;
  batch->take(bodies, now, box, looks, count);

  FinderCounters expected;
  int answers = 0;
  int contacts = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    Pair& pair = scalar[k];
    if (!looks[k].answered) {
      expect_same_bits(pairs[k].normal, pair.normal);
      continue;
    }
    ++answers;
    const Vector3d r = nearest_image(bodies.position_at(pair.j, now) - bodies.position_at(pair.i, now), box);
    std::optional<Unsolved> unsolved;
    const Finding finding =
        bodies.find_contact(pair.i, pair.j, r, now, looks[k].end, 1, {}, pair.normal, expected, unsolved);
    EXPECT_EQ(looks[k].finding.outcome, finding.outcome) << k;
    EXPECT_EQ(bits(looks[k].finding.time), bits(finding.time)) << k;
    expect_same_bits(pairs[k].normal, pair.normal);
    contacts += finding.outcome == Outcome::contact ? 1 : 0;
  }
  EXPECT_EQ(count.predictions, static_cast<std::uint64_t>(answers));
  EXPECT_EQ(count.predictions, expected.predictions);
  EXPECT_EQ(count.evaluations, expected.evaluations);
  EXPECT_EQ(count.kernel_calls, expected.kernel_calls);
  EXPECT_EQ(expected.cold_restarts + expected.rescues + expected.newton_evaluations, 0U);
  return {answers / static_cast<double>(pairs.size()), contacts};
}

/// Returns the number of contacts among the answers, of all instruction sets together.
int expect_same_looks(const std::vector<Species>& species, double least_share = 0.5) {
  const int repetitions = full_form() ? 200 : 20;
  int contacts = 0;
  for (const geom::InstructionSet set : geom_test::instruction_sets()) {
    double answered = 0;
    for (int k = 0; k < repetitions; ++k) {
      const Answers found = expect_same_looks(species, set, 100 + static_cast<std::uint64_t>(k));
      answered += found.share / repetitions;
      contacts += found.contacts;
    }
    std::printf("%s: %.3f of the looks answered\n", geom::to_string(set), answered);
    EXPECT_GT(answered, least_share);
  }
  return contacts;
}

Species paper(double aspect_ratio) {
  return paper_species(ed_test::spheroid(aspect_ratio));
}
Species uniform(double aspect_ratio) {
  return uniform_species(ed_test::spheroid(aspect_ratio));
}

TEST(FirstLooks, OfRodsAreThoseOfOnePair) {
  expect_same_looks({paper(3)});
}

TEST(FirstLooks, OfLongRodsAreThoseOfOnePair) {
  expect_same_looks({paper(8)});
}

TEST(FirstLooks, OfDiscsAreThoseOfOnePair) {
  expect_same_looks({paper(0.3)});
}

TEST(FirstLooks, OfSpheresAreThoseOfOnePair) {
  expect_same_looks({paper(1)});
}

TEST(FirstLooks, OfSpinningRodsAreThoseOfOnePair) {
  expect_same_looks({uniform(3)});
}

TEST(FirstLooks, OfSpinningDiscsAreThoseOfOnePair) {
  expect_same_looks({uniform(0.3)});
}

TEST(FirstLooks, OfMixturesAreThoseOfOnePair) {
  expect_same_looks({paper(3), paper(0.4), paper(1)});
  expect_same_looks({uniform(2), paper(0.4), uniform(0.2), uniform(1)});
}

Species capsule(double aspect_ratio, double radius = 0.5) {
  return uniform_species(geom::Capsule(radius * aspect_ratio, radius));
}
Species without_spin(Species species) {
  species.spins = false;
  return species;
}

TEST(FirstLooks, OfCapsulesAreThoseOfOnePair) {
  expect_same_looks({without_spin(capsule(2))});
  expect_same_looks({without_spin(capsule(10))});
}

TEST(FirstLooks, OfSpinningCapsulesAreThoseOfOnePair) {
  expect_same_looks({capsule(2)});
}

TEST(FirstLooks, OfCapsulesAndSpheresAreThoseOfOnePair) {
  expect_same_looks({without_spin(capsule(3)), without_spin(capsule(1, 0.7)), uniform_species(geom::Sphere(0.6))});
  expect_same_looks({capsule(0.3), without_spin(capsule(5)), uniform_species(geom::Sphere(0.2))});
}

// Only pairs of one family have kernels: a capsule beside an ellipsoid stays unanswered.
TEST(FirstLooks, OfCapsulesAndEllipsoidsAreThoseOfOnePair) {
  const Species ball = uniform_species(geom::Sphere(0.6));
  expect_same_looks({without_spin(capsule(2)), paper(3), ball}, 0.4);
  expect_same_looks({capsule(2), uniform(0.3), ball, uniform(3)}, 0.4);
}

TEST(FirstLooks, OfSpheresInClosedFormAreThoseOfOnePair) {
  EXPECT_GT(expect_same_looks({uniform_species(geom::Sphere(0.6))}), 0) << "contacts are answered too";
  EXPECT_GT(expect_same_looks({uniform_species(geom::Sphere(1)), uniform_species(geom::Sphere(0.3))}), 0);
}

TEST(FirstLooks, AreTakenOneByOneWherePairsNeedMore) {
  System system;
  system.box = 20;
  system.species = {paper(3)};
  system.bodies.resize(2);
  system.bodies[1].position = Vector3d(3, 0, 0);
  const UniaxialBodies bodies(system);
  SimulationOptions options;
  options.batches.reset();
  EXPECT_EQ(make_first_looks(bodies, options), nullptr);
  options = {};
  options.batches = geom::InstructionSet::portable;
  EXPECT_NE(make_first_looks(bodies, options), nullptr);
  options.neighbours = Neighbours::cells;
  EXPECT_EQ(make_first_looks(bodies, options), nullptr);
  options.neighbours = Neighbours::obp;
  options.contact.finder = Finder::bracketing;
  EXPECT_EQ(make_first_looks(bodies, options), nullptr);
}

TEST(FirstLooks, RefuseInstructionSetsThatAreNotThere) {
  System system;
  system.box = 20;
  system.species = {paper(3)};
  system.bodies.resize(2);
  system.bodies[1].position = Vector3d(10, 0, 0);
  for (const geom::InstructionSet set : {geom::InstructionSet::avx2, geom::InstructionSet::avx512}) {
    SimulationOptions options;
    options.batches = set;
    if (geom::is_available(set)) {
      EXPECT_NO_THROW(Simulation(system, options));
    } else {
      EXPECT_THROW(Simulation(system, options), std::invalid_argument);
    }
  }
}

}  // namespace
}  // namespace ed::internal
