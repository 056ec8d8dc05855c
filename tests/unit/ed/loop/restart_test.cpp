// A simulation that is saved, and restored from the bytes, goes on as if nothing had happened: every bit of what it
// would save later is the same, which is all there is of it.

#include "bodies/body_events.h"

#include <common/ed/families.h>
#include <common/ed/states.h>
#include <common/finder/scale.h>
#include <common/full_form.h>
#include <common/message_of.h>

#include <ed/archive.h>
#include <ed/ed.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using ed::Finder;
using ed::Neighbours;
using ed_test::Inertia;

struct Case {
  std::string name;
  ed::System system;
};

ed::System mixture_of_revolution() {
  const std::vector<ed::Component> components = {{ed::paper_species(ed_test::spheroid(3)), 60},
                                                 {ed::uniform_species(ed_test::spheroid(0.6), 2), 68}};
  ed::StartOptions options;
  options.packing_fraction = 0.25;
  return ed::random_start(components, options);
}

/// Two large bodies among small ones: cells of two classes.
ed::System few_large() {
  const ed::Species small = ed::paper_species(ed_test::spheroid(0.9));
  ed::StartOptions options;
  options.packing_fraction = 0.02;
  return ed::random_start({{small, 126}, {ed::scaled(small, 8), 2}}, options);
}

std::vector<Case> make_cases() {
  std::vector<Case> all = {{"rods", ed_test::start({2, 0.3, 128, Inertia::paper, 7})},
                           {"spinning discs", ed_test::start({0.5, 0.3, 128, Inertia::uniform, 7})},
                           {"a mixture of revolution", mixture_of_revolution()},
                           {"few large ones", few_large()}};
  for (const ed_test::Family& family : ed_test::families(128)) {
    all.push_back({family.name, ed_test::start(family, 0.25)});
  }
  return all;
}

const std::vector<Case>& cases() {
  static const std::vector<Case> all = make_cases();
  return all;
}

std::vector<ed::SimulationOptions> all_options() {
  std::vector<ed::SimulationOptions> all;
  for (const Neighbours neighbours : {Neighbours::dilated, Neighbours::obp, Neighbours::cells}) {
    for (const Finder finder : {Finder::certified, Finder::bracketing}) {
      ed::SimulationOptions options;
      options.neighbours = neighbours;
      options.contact.finder = finder;
      all.push_back(options);
    }
  }
  return all;
}

std::string describe(const Case& c, const ed::SimulationOptions& options) {
  return c.name + ", neighbours " + std::to_string(static_cast<int>(options.neighbours)) + ", finder " +
         std::to_string(static_cast<int>(options.contact.finder));
}

/// Runs on for some epochs, restored from its own bytes again and again or not at all.
std::string goes_on(ed::Simulation simulation, const Case& c, const ed::SimulationOptions& options, bool restarted) {
  for (int stretch = 0; stretch < 12; ++stretch) {
    simulation.run_collisions(17);
    simulation.run_until(simulation.time() + 0.1);
    if (!restarted) continue;
    const std::string state = simulation.save();
    EXPECT_EQ(simulation.save(), state);
    simulation = ed::Simulation::restore(state, c.system.species, options);
    EXPECT_EQ(simulation.save(), state);
  }
  EXPECT_GT(simulation.time(), ed::time_unit(c.system));
  return simulation.save();
}

TEST(Restart, EveryBitIsThere) {
  for (const Case& c : cases()) {
    for (const ed::SimulationOptions& options : all_options()) {
      // The paper's finder takes ten times as long as the other one.
      const bool paper = options.contact.finder == Finder::bracketing;
      if (paper && short_form() && &c != &cases().front()) continue;
      ed::Simulation undisturbed(c.system, options);
      undisturbed.record_collisions(300);
      ed::Simulation other(c.system, options);
      other.record_collisions(300);
      const std::string expected = goes_on(std::move(undisturbed), c, options, false);
      EXPECT_TRUE(goes_on(std::move(other), c, options, true) == expected) << describe(c, options);
    }
  }
}

TEST(Restart, CountersCollisionsAndTimesGoOn) {
  const Case& c = cases()[0];
  ed::Simulation simulation(c.system);
  simulation.record_collisions(200);
  simulation.run_collisions(150);
  ed::Simulation restored = ed::Simulation::restore(simulation.save(), c.system.species);
  EXPECT_EQ(restored.counters().collisions, 150U);
  EXPECT_EQ(restored.counters().evaluations, simulation.counters().evaluations);
  EXPECT_EQ(restored.time(), simulation.time());
  EXPECT_EQ(restored.box(), simulation.box());
  EXPECT_EQ(restored.envelope(), simulation.envelope());
  ASSERT_EQ(restored.collisions().size(), 150U);
  EXPECT_EQ(restored.collisions()[149].time, simulation.collisions()[149].time);
  restored.run_collisions(100);
  EXPECT_EQ(restored.collisions().size(), 200U);
}

TEST(Restart, CompressionGoesOn) {
  const Case& c = cases()[0];
  ed::Simulation simulation(c.system);
  const auto compress = [](ed::Simulation& s) {
    for (int round = 0; round < 40; ++round) {
      s.run_until(s.time() + 0.02);
      s.shrink_box(0.97 * s.box());
    }
  };
  compress(simulation);
  ed::Simulation restored = ed::Simulation::restore(simulation.save(), c.system.species);
  compress(simulation);
  compress(restored);
  EXPECT_LT(restored.box(), 0.999 * c.system.box);
  EXPECT_TRUE(restored.save() == simulation.save());
}

TEST(Restart, EnvelopesThatWereTunedAreKept) {
  const Case& c = cases()[1];
  ed::Simulation simulation(c.system);
  simulation.tune_envelopes();
  ed::Simulation restored = ed::Simulation::restore(simulation.save(), c.system.species);
  simulation.run_collisions(500);
  restored.run_collisions(500);
  EXPECT_TRUE(restored.save() == simulation.save());
}

/// Returns the centres of both bodies: Newton's method declines, the failure is kept, the dual answers.
geom::WitnessPair middles(const geom::Shape& /*a*/, const geom::Pose& X_WA, const geom::Shape& /*b*/,
                          const geom::Pose& X_WB) {
  return {X_WA.position(), X_WB.position(), geom::SeedStatus::usable};
}

TEST(Restart, FailuresAreKept) {
  const Case& c = cases()[0];
  ed::SimulationOptions options;
  options.contact.finder = Finder::bracketing;
  options.contact.distance = ed::DistanceMethod::newton5;
  options.contact.seed = middles;
  ed::Simulation simulation(c.system, options);
  ASSERT_EQ(simulation.failures().size(), 16U);
  const ed::Simulation restored = ed::Simulation::restore(simulation.save(), c.system.species, options);
  ASSERT_EQ(restored.failures().size(), 16U);
  const ed::FailedPair& kept = restored.failures()[7];
  const ed::FailedPair& failed = simulation.failures()[7];
  EXPECT_EQ(kept.motion_j.pose.rotation(), failed.motion_j.pose.rotation());
  EXPECT_EQ(ed::describe(kept.shape_j), ed::describe(failed.shape_j));
  EXPECT_EQ(kept.distance->seed.point_b, failed.distance->seed.point_b);
  EXPECT_EQ(restored.counters().unrecorded_failures, simulation.counters().unrecorded_failures);
}

std::string refusal(const std::string& state, const std::vector<ed::Species>& species,
                    const ed::SimulationOptions& options = {}) {
  return test_common::message_of([&] { ed::Simulation::restore(state, species, options); });
}

TEST(Restart, OtherSpeciesAndOptionsAreRefused) {
  const Case& c = cases()[0];
  const std::string state = ed::Simulation(c.system).save();
  std::vector<ed::Species> species = c.system.species;
  species[0].mass = 2;
  EXPECT_EQ(refusal(state, species), "state: is one of other species");
  for (const ed::SimulationOptions& options : all_options()) {
    const bool same = options.neighbours == Neighbours::dilated && options.contact.finder == Finder::certified;
    EXPECT_EQ(refusal(state, c.system.species, options),
              same ? "no std::invalid_argument" : "state: was made with another finder or other neighbours");
  }
  std::string later = state;
  later[0] = 9;
  EXPECT_EQ(refusal(later, c.system.species), "state: has format 9, known is 8");
  EXPECT_EQ(refusal(state + "x", c.system.species), "state: is longer than it should be");
}

// ---- Stalls

TEST(Stall, EndsTheRunAndSaysInWhat) {
  const Case& c = cases()[0];
  ed::SimulationOptions options;
  options.least_progress = 1e9;  // no run makes so much
  ed::Simulation simulation(c.system, options);
  EXPECT_FALSE(simulation.run_until(1e6));
  ASSERT_TRUE(simulation.stall().has_value());
  const ed::Stall stall = *simulation.stall();
  EXPECT_GE(stall.events, 2000U * 128U);
  EXPECT_LE(stall.events, 2000U * 128U + 1000U);
  EXPECT_EQ(stall.time, simulation.time());
  EXPECT_GT(stall.share, 0);
  EXPECT_TRUE(stall.i >= 0 && stall.i < 128 && stall.j < 128);
  EXPECT_THAT(ed::describe(stall), testing::HasSubstr("events in"));
  // It stays where it is: nothing is processed any more. Restored, it tries again.
  const std::string state = simulation.save();
  EXPECT_FALSE(simulation.run_until(1e6));
  EXPECT_TRUE(simulation.save() == state);
  ed::Simulation again = ed::Simulation::restore(state, c.system.species, options);
  EXPECT_FALSE(again.stall().has_value());
  EXPECT_FALSE(again.run_until(1e6));
  EXPECT_TRUE(again.stall().has_value());
}

/// A caller gets its turn however many events there are without a collision, and takes it without a trace.
TEST(Stall, IsWaitedForInSlices) {
  const Case& c = cases()[0];
  ed::SimulationOptions options;
  options.least_progress = 1e9;
  ed::Simulation whole(c.system, options);
  EXPECT_FALSE(whole.run_until(1e6));
  ASSERT_TRUE(whole.stall().has_value());
  ed::Simulation sliced(c.system, options);
  std::uint64_t slices = 0;
  while (!sliced.stall()) {
    EXPECT_FALSE(sliced.run_until(1e6, ~std::uint64_t{0}, 777));
    ++slices;
  }
  EXPECT_EQ(slices, 1 + (2000 * 128 - 1) / 777);
  EXPECT_EQ(ed::describe(*sliced.stall()), ed::describe(*whole.stall()));
  EXPECT_TRUE(sliced.save() == whole.save());
  // Without events left the end can be reached.
  ed::Simulation still(c.system);
  EXPECT_TRUE(still.run_until(0, 1, 0));
  EXPECT_FALSE(still.run_until(1e6, 1, 0));
}

TEST(Stall, SoundRunsAreNone) {
  // The densest of spheres, which collide some hundred times a time unit, and a dilute gas.
  for (const double phi : {0.73, 0.01}) {
    ed::LatticeOptions lattice;
    lattice.packing_fraction = phi;
    const ed::System system = ed::lattice_start({{ed::uniform_species(ed_test::spheroid(1)), 108}}, lattice);
    ed::SimulationOptions options;
    options.least_progress = 1e-2;  // far more than is asked for
    ed::Simulation simulation(system, options);
    EXPECT_TRUE(simulation.run_until(finder_test::scaled(50, 50))) << phi;
  }
}

// ---- Observables

struct Measured {
  ed::Simulation simulation;
  ed::Observables observables;
};

ed::ObservablesOptions options_for(const Case& c, double duration) {
  ed::ObservablesOptions options{};
  options.number = c.system.size();
  options.duration = duration;
  options.longest_lag = 0.03;  // short: more blocks than are kept
  const int half = options.number / 2;
  const int axes = ed::symmetry_axis(c.system.species_of(options.number - 1)) ? 2 : 3;
  options.groups = {{half, 2}, {options.number - half, axes}};
  return options;
}

/// Duration of the measurements, long enough for blocks to be merged on the way.
const double kDuration = short_form() ? 0.3 : 1;

/// Restored before every 61st measurement, or never.
std::string measure(Measured run, const Case& c, bool restarted) {
  const ed::ObservablesOptions options = options_for(c, kDuration);
  for (int k = 0; run.observables.next_time() <= options.duration; ++k) {
    run.simulation.run_until(run.observables.next_time());
    if (restarted && k % 61 == 0) {
      const std::string state = run.observables.save();
      run.observables = ed::Observables::restore(state, options);
      EXPECT_TRUE(run.observables.save() == state);
    }
    run.observables.measure(run.simulation);
  }
  return run.observables.save();
}

TEST(Restart, ObservablesGoOn) {
  for (const Case* one : {&cases().front(), &cases().back()}) {
    const Case& c = *one;
    const auto begin = [&] { return Measured{ed::Simulation(c.system), ed::Observables(options_for(c, kDuration))}; };
    const std::string expected = measure(begin(), c, false);
    EXPECT_TRUE(measure(begin(), c, true) == expected) << c.name;
    const auto refused = [&](const std::string& state, const ed::ObservablesOptions& options) {
      return test_common::message_of([&] { ed::Observables::restore(state, options); });
    };
    EXPECT_EQ(refused(expected, options_for(c, 2 * kDuration)), "state: the observables are those of another run");
    for (std::size_t length = 0; length < expected.size(); length += 1 + length / 50) {
      EXPECT_THAT(refused(expected.substr(0, length), options_for(c, kDuration)), testing::StartsWith("state: "))
          << length;
    }
  }
}

/// Damages bytes without a checksum: whatever they say, they are refused or give a state that can be used.
TEST(Restart, DamagedBytesAreNeverTrusted) {
  for (const Case* one : {&cases().front(), &cases().back()}) {
    const Case& c = *one;
    ed::Simulation simulation(c.system);
    simulation.record_collisions(3);
    simulation.run_collisions(100);
    const std::string state = simulation.save();
    for (std::size_t length = 0; length < state.size(); length += 1 + length / 50) {
      EXPECT_THAT(refusal(state.substr(0, length), c.system.species), testing::StartsWith("state: ")) << length;
    }
    ed::Random random(1);
    int refused = 0;
    for (int k = 0; k < 3000; ++k) {
      std::string bad = state;
      bad[random.bits() % bad.size()] ^= static_cast<char>(1 + random.bits() % 255);
      try {
        const ed::Simulation restored = ed::Simulation::restore(bad, c.system.species);
        EXPECT_EQ(restored.system().size(), c.system.size());
      } catch (const std::invalid_argument&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 100);
  }
}

/// Replaces the last of three equal thicknesses of envelopes that follow each other in a state: of the loop, of the
/// envelopes, and up to an exit.
TEST(Restart, EnvelopesWithoutAnExitAreRefused) {
  for (const Case* one : {&cases().front(), &cases().back()}) {
    const ed::Simulation simulation(one->system);
    const std::string state = simulation.save();
    const double t = simulation.envelope();
    const std::size_t at = state.find(ed::archive::bytes_of(Eigen::Vector3d(t, t, t)));
    ASSERT_NE(at, std::string::npos);
    for (const double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), -1.0}) {
      std::string changed = state;
      changed.replace(at + 2 * sizeof bad, sizeof bad, ed::archive::bytes_of(bad));
      EXPECT_THAT(refusal(changed, one->system.species), testing::HasSubstr("exit")) << bad;
    }
  }
}

/// A body whose exit is not a number would never be looked at again.
TEST(Restart, ExitsThatAreNoNumbersAreRefused) {
  ed::internal::BodyEvents events;
  for (const double exit : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    events.exit = exit;
    const std::string bytes = ed::archive::bytes_of(events);
    EXPECT_EQ(ed::archive::Reader(bytes).value<ed::internal::BodyEvents>().exit, exit);
  }
  events.exit = std::numeric_limits<double>::quiet_NaN();
  const std::string bytes = ed::archive::bytes_of(events);
  EXPECT_THROW((void)ed::archive::Reader(bytes).value<ed::internal::BodyEvents>(), std::invalid_argument);
}

}  // namespace
