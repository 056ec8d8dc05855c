// The physics does not depend on how the event loop is run: the finder, the kind of neighbour lists and the thickness
// of their envelopes, where runs are cut into pieces, and when they are looked at.

#include <common/ed_hash.h>
#include <common/ed_states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace {

using ed_test::Inertia;
using ed_test::State;

/// Neighbours are looked at from other times and with other normals, so contacts are found with other rounding errors
/// (about 1e-15 of the time), which the dynamics multiplies; in the first 1000 collisions, some four a body, by less
/// than 1e3. A wrong or missing collision changes times by a good part of the mean time between collisions, 1e-4.
constexpr double kSameTime = 1e-9;

constexpr std::size_t kNumber = 1000;

std::vector<ed::Collision> first_collisions(const ed::System& system, const ed::SimulationOptions& options,
                                            std::size_t number = kNumber) {
  ed::Simulation simulation(system, options);
  simulation.record_collisions(number);
  simulation.run_collisions(number);
  EXPECT_EQ(simulation.counters().overlaps, 0U);
  return simulation.collisions();
}

/// The largest difference of times.
double compare(const std::vector<ed::Collision>& a, const std::vector<ed::Collision>& b, const std::string& what) {
  EXPECT_EQ(a.size(), kNumber);
  EXPECT_EQ(b.size(), kNumber);
  double worst = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    if (a[k].i != b[k].i || a[k].j != b[k].j) {
      ADD_FAILURE() << what << ": collision " << k << " is of " << b[k].i << " and " << b[k].j << " instead of "
                    << a[k].i << " and " << a[k].j;
      return std::numeric_limits<double>::infinity();
    }
    worst = std::max(worst, std::abs(a[k].time - b[k].time));
    EXPECT_GE(b[k].time, b[k > 0 ? k - 1 : 0].time) << what;
  }
  return worst;
}

void expect_same_collisions(const State& state, double thin, double thick) {
  const ed::System system = ed_test::equilibrated(state, 0.5);
  ASSERT_NE(ed::Simulation(system, {thin}).envelope(), ed::Simulation(system, {thick}).envelope());
  const double worst =
      compare(first_collisions(system, {thin}), first_collisions(system, {thick}), ed_test::describe(state));
  std::printf("%s: times differ by %.1e at most\n", ed_test::describe(state).c_str(), worst);
  EXPECT_LE(worst, kSameTime);
}

struct Mode {
  const char* name;
  ed::Finder finder;
  ed::Neighbours neighbours;
  ed::DistanceMethod distance = ed::DistanceMethod::dual;
  ed::ContactRoot root = ed::ContactRoot::newton;
};

/// The paper's finder, lists and distances, in every combination that differs, against the default path.
void expect_same_collisions_in_every_mode(const State& state) {
  using ed::DistanceMethod;
  using ed::Finder;
  using ed::Neighbours;
  const ed::System system = ed_test::equilibrated(state, 0.5);
  const auto reference = first_collisions(system, {});
  for (const Mode& mode :
       {Mode{"certified, obp", Finder::certified, Neighbours::obp},
        Mode{"certified, cells", Finder::certified, Neighbours::cells},
        Mode{"bracketing, dilated", Finder::bracketing, Neighbours::dilated},
        Mode{"bracketing, obp", Finder::bracketing, Neighbours::obp},
        Mode{"bracketing, cells", Finder::bracketing, Neighbours::cells},
        Mode{"bracketing, dilated, 1-D root", Finder::bracketing, Neighbours::dilated, DistanceMethod::dual,
             ed::ContactRoot::one_dimensional},
        Mode{"bracketing, obp, newton5", Finder::bracketing, Neighbours::obp, DistanceMethod::newton5},
        Mode{"bracketing, obp, newton8", Finder::bracketing, Neighbours::obp, DistanceMethod::newton8}}) {
    ed::SimulationOptions options;
    options.neighbours = mode.neighbours;
    options.contact.finder = mode.finder;
    options.contact.distance = mode.distance;
    options.contact.root = mode.root;
    options.contact.eps_d = 1e-6;
    const double worst = compare(reference, first_collisions(system, options), mode.name);
    std::printf("%s, %s: times differ by %.1e at most\n", ed_test::describe(state).c_str(), mode.name, worst);
    EXPECT_LE(worst, kSameTime) << mode.name;
  }
}

TEST(SameCollisions, InEveryModeOfDiscs) {
  expect_same_collisions_in_every_mode({0.33, 0.40, 512, Inertia::paper, 51});
}

TEST(SameCollisions, InEveryModeOfShortRods) {
  expect_same_collisions_in_every_mode({2, 0.40, 512, Inertia::paper, 52});
}

TEST(SameCollisions, InEveryModeOfRods) {
  expect_same_collisions_in_every_mode({3, 0.40, 512, Inertia::paper, 53});
}

TEST(SameCollisions, InEveryModeOfSpinningRods) {
  expect_same_collisions_in_every_mode({2, 0.40, 256, Inertia::uniform, 54});
}

TEST(SameCollisions, WhateverTheEnvelopeOfRods) {
  expect_same_collisions({3, 0.40, 256, Inertia::paper, 41}, 0.15, 0.6);
}

TEST(SameCollisions, WhateverTheEnvelopeOfSpinningDiscs) {
  expect_same_collisions({0.4, 0.40, 256, Inertia::uniform, 42}, 0.1, 0.7);
}

TEST(SameCollisions, WhateverTheEnvelopeOfSpheres) {
  expect_same_collisions({1, 0.45, 256, Inertia::paper, 43}, 0.1, 0.8);
}

/// Runs to `time` in slices of irregular length, most of them without an event in them, and looks at the state in
/// between.
std::uint64_t hash_in_slices(const ed::System& system, double time) {
  ed::Simulation simulation(system);
  ed::Random random(7);
  ed::Snapshot snapshot;
  while (simulation.time() < time) {
    const double slice = 0.02 * random.uniform() * random.uniform();
    // Every now and then the slice ends after a few collisions instead.
    const bool by_number = random.uniform() < 0.2;
    simulation.run_until(std::min(time, simulation.time() + slice), by_number ? 3 : ~std::uint64_t{0});
    if (random.uniform() < 0.05) {
      simulation.sample(snapshot);
      EXPECT_TRUE(ed::audit(simulation.system()).finite);
    }
  }
  return ed_test::hash_of(simulation);
}

std::uint64_t hash_at_once(const ed::System& system, double time) {
  ed::Simulation simulation(system);
  EXPECT_TRUE(simulation.run_until(time));
  return ed_test::hash_of(simulation);
}

void expect_same_bits(const State& state) {
  const ed::System system = ed_test::start(state);
  // Several epochs of the event loop, and an end that is none.
  constexpr double kTime = 3.3;
  const std::uint64_t at_once = hash_at_once(system, kTime);
  EXPECT_EQ(at_once, hash_at_once(system, kTime));
  EXPECT_EQ(at_once, hash_in_slices(system, kTime));
  EXPECT_NE(at_once, hash_at_once(system, kTime * 1.0001));
}

TEST(SameBits, OfRodsInManySlicesAndAtOnce) {
  expect_same_bits({3, 0.40, 128, Inertia::paper, 44});
}

TEST(SameBits, OfSpinningDiscsInManySlicesAndAtOnce) {
  expect_same_bits({0.5, 0.40, 128, Inertia::uniform, 45});
}

TEST(SameBits, WhenTheSimulationIsMovedFrom) {
  const ed::System system = ed_test::start({2, 0.30, 64, Inertia::uniform, 46});
  ed::Simulation first(system);
  first.run_until(0.5);
  ed::Simulation second(std::move(first));
  second.run_until(1.5);
  EXPECT_EQ(ed_test::hash_of(second), hash_at_once(system, 1.5));
}

}  // namespace
