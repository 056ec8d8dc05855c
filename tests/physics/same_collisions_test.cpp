// The physics does not depend on how the event loop is run: the finder, the kind of neighbour lists and the thickness
// of their envelopes, where runs are cut into pieces, and when states are read.

#include <common/ed/hash.h>
#include <common/ed/same_collisions.h>
#include <common/ed/states.h>
#include <common/geom/batch.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace {

using ed_test::expect_same;
using ed_test::first_collisions;
using ed_test::Inertia;
using ed_test::Mode;
using ed_test::State;

void expect_same_collisions(const State& state, double thin, double thick) {
  const ed::System system = ed_test::equilibrated(state, 0.5);
  ASSERT_NE(ed::Simulation(system, {thin}).envelope(), ed::Simulation(system, {thick}).envelope());
  expect_same(first_collisions(system, {thin}), first_collisions(system, {thick}), ed_test::describe(state));
}

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
    expect_same(reference, first_collisions(system, mode.options(1e-6)), ed_test::describe(state) + ", " + mode.name);
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

/// Pairs looked at one by one, and in vectors of every instruction set: the same bits, not only the same collisions.
void expect_same_bits_in_vectors(const State& state) {
  const ed::System system = ed_test::equilibrated(state, 0.5);
  const auto run = [&](std::optional<geom::InstructionSet> batches) {
    ed::SimulationOptions options;
    options.batches = batches;
    ed::Simulation simulation(system, options);
    simulation.record_collisions(1000);
    simulation.run_collisions(2000);
    return simulation;
  };
  const ed::Simulation one_by_one = run(std::nullopt);
  for (const geom::InstructionSet set : geom_test::instruction_sets()) {
    const ed::Simulation in_vectors = run(set);
    const std::string what = ed_test::describe(state) + ", " + geom::to_string(set);
    expect_same(one_by_one.collisions(), in_vectors.collisions(), what);
    EXPECT_EQ(ed_test::hash_of(one_by_one), ed_test::hash_of(in_vectors)) << what;
    EXPECT_EQ(one_by_one.counters().predictions, in_vectors.counters().predictions) << what;
    EXPECT_EQ(one_by_one.counters().evaluations, in_vectors.counters().evaluations) << what;
    EXPECT_EQ(one_by_one.counters().kernel_calls, in_vectors.counters().kernel_calls) << what;
    EXPECT_EQ(one_by_one.counters().refinements, in_vectors.counters().refinements) << what;
    EXPECT_EQ(one_by_one.counters().candidate_tests, in_vectors.counters().candidate_tests) << what;
  }
}

TEST(SameBits, OfRodsOneByOneAndInVectors) {
  expect_same_bits_in_vectors({3, 0.40, 512, Inertia::paper, 61});
}

TEST(SameBits, OfSpinningDiscsOneByOneAndInVectors) {
  expect_same_bits_in_vectors({0.3, 0.40, 256, Inertia::uniform, 62});
}

TEST(SameBits, OfSpheresOneByOneAndInVectors) {
  expect_same_bits_in_vectors({1, 0.45, 256, Inertia::paper, 63});
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
