/// `hardbody check` on states that no sound run ends in, and what counts as a defect of a run.

#include "checkpoint_states.h"
#include "config/config.h"
#include "run/record.h"

#include <ed/simulation.h>

#include <gtest/gtest.h>

#include <limits>
#include <utility>

namespace {

using cli_test::check_status;
using cli_test::checkpoint_of;
using cli_test::dilute_state;
using cli_test::kConfig;
using cli_test::kMixture;
using cli_test::mixed_state;

TEST(Check, SoundStatePasses) {
  EXPECT_EQ(check_status(checkpoint_of(dilute_state())), 0);
}

TEST(Check, SoundMixturePasses) {
  EXPECT_EQ(check_status(checkpoint_of(mixed_state(), kMixture)), 0);
}

TEST(Check, BodiesOfAnotherShapeMassOrInertiaAreFound) {
  const ed::System sound = mixed_state();
  ed::System state = sound;
  std::swap(state.bodies[0].species, state.bodies[20].species);
  EXPECT_EQ(check_status(checkpoint_of(state, kMixture)), 1);
  state = sound;
  state.species[2].shape = geom::Superellipsoid(ed::half_extents(state.species[2].shape), 0.5, 1.25);
  EXPECT_EQ(check_status(checkpoint_of(state, kMixture)), 1);
  state = sound;
  state.species[1].mass *= 2;
  EXPECT_EQ(check_status(checkpoint_of(state, kMixture)), 1);
  // A little: the energy still passes.
  state = sound;
  state.species[1].inertia *= 1 + 1e-11;
  EXPECT_EQ(check_status(checkpoint_of(state, kMixture)), 1);
}

TEST(Check, OverlapIsFound) {
  ed::System state = dilute_state();
  // A fifth of the sum of the smallest semi-axes deep, side by side; the rest of the gas is far away on average.
  state.bodies[1] = state.bodies[0];
  state.bodies[1].position += 1.8 * ed::inscribed_radius(state.species[0].shape) * state.bodies[0].rotation.col(0);
  EXPECT_EQ(check_status(checkpoint_of(state)), 1);
}

TEST(Check, CoincidingBodiesAreFound) {
  ed::System state = dilute_state();
  state.bodies[1] = state.bodies[0];
  EXPECT_EQ(check_status(checkpoint_of(state)), 1);
}

TEST(Check, NumbersThatAreNotFiniteAreFound) {
  for (const double number : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    ed::System state = dilute_state();
    state.bodies[7].velocity.y() = number;
    EXPECT_EQ(check_status(checkpoint_of(state)), 1);
    state = dilute_state();
    state.bodies[7].position.y() = number;
    EXPECT_EQ(check_status(checkpoint_of(state)), 1);
  }
}

TEST(Check, StateOfAnotherPackingFractionIsFound) {
  ed::System state = dilute_state();
  state.box *= 1.001;
  EXPECT_EQ(check_status(checkpoint_of(state)), 1);
}

TEST(Check, ImpossibleStatesAreRefused) {
  ed::System state = dilute_state();
  state.bodies[3].rotation *= 2;
  EXPECT_EQ(check_status(checkpoint_of(state)), 2);
  state = dilute_state();
  state.box = -1;
  EXPECT_EQ(check_status(checkpoint_of(state)), 2);
  state = dilute_state();
  state.bodies.clear();
  EXPECT_EQ(check_status(checkpoint_of(state)), 2);
}

TEST(Defects, OverlapsMetOnTheWayCount) {
  hardbody::RunRecord record;
  record.config = hardbody::parse_config(kConfig, "memory");
  record.equilibration.system = dilute_state();
  record.equilibration.kinetic_at_start = ed::kinetic_state(record.equilibration.system);
  hardbody::audit_record(record);
  EXPECT_TRUE(hardbody::defects(record).empty());
  record.equilibration.counters.overlaps = 1;
  EXPECT_EQ(hardbody::defects(record).size(), 1u);
  record.production.counters.overlaps = 1;
  EXPECT_EQ(hardbody::defects(record).size(), 2u);
}

TEST(Check, JudgesEnergyAndMomentum) {
  const ed::System sound = dilute_state();
  EXPECT_EQ(check_status(checkpoint_of(sound)), 0);
  ed::System hot = sound;
  for (ed::Body& body : hot.bodies) body.velocity *= 1 + 1e-8;
  EXPECT_EQ(check_status(checkpoint_of(hot)), 1);
  ed::System drifting = sound;
  for (ed::Body& body : drifting.bodies) body.velocity.x() += 1e-8;
  EXPECT_EQ(check_status(checkpoint_of(drifting)), 1);
  // Spin is part of the energy.
  ed::System spinning = sound;
  spinning.species[0].spins = true;
  EXPECT_EQ(hardbody::conservation_defects(ed::kinetic_state(spinning), spinning).size(), 1U);
}

}  // namespace
