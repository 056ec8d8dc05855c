// When a run counts as equilibrated: motions with known relaxation.

#include <common/ed/observed.h>
#include <common/ed/states.h>
#include <common/message_of.h>

#include <ed/ed.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using ed_test::Inertia;

/// Returns the monitor's state after each of `units` time units.
std::vector<ed::Relaxation> watched(const ed::System& system, const std::vector<ed::RelaxingGroup>& groups, int units) {
  ed::Simulation simulation(system);
  ed::EquilibrationMonitor monitor(simulation, groups);
  std::vector<ed::Relaxation> states;
  for (int k = 1; k <= units; ++k) {
    simulation.run_until(k);
    monitor.measure(simulation);
    states.push_back(monitor.state());
  }
  return states;
}

TEST(Equilibration, OfAFluidTakesTwoRelaxations) {
  const ed::System system = ed_test::start({2, 0.3, 216, Inertia::paper, 1});
  const std::vector<ed::Relaxation> states = watched(system, {{216}}, 40);
  EXPECT_FALSE(states[6].reached);
  EXPECT_TRUE(states.back().reached);
  bool before = false;
  for (const ed::Relaxation& state : states) {
    // Once it is, it stays.
    EXPECT_TRUE(state.reached || !before);
    if (state.reached && !before) {
      EXPECT_GE(state.relaxations, 2);
      EXPECT_GE(state.relaxation_time, 4);
      EXPECT_LT(state.c2, 0.05);
      EXPECT_LT(state.f_self, 0.05);
      EXPECT_LT(std::abs(state.S_change), 0.2);
      EXPECT_TRUE(state.q > 2 && state.q < 6);
    }
    before = state.reached;
  }
}

TEST(Equilibration, WaveNumberHardlyDependsOnTheSeed) {
  // Even at densities at which the highest S(q) between 1.5 and 7 is chance. X0, packing fraction, and where S(q) of a
  // run of 400 time units has its peak.
  struct State {
    double X0, phi, q;
  };
  for (const State& state : {State{2, 0.1, 2.9}, State{2, 0.3, 3.2}, State{0.2, 0.15, 2.5}, State{0.5, 0.1, 2.85}}) {
    double sum = 0, squares = 0;
    constexpr int kSeeds = 8;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      const ed::System system =
          ed_test::start({state.X0, state.phi, 216, Inertia::paper, static_cast<std::uint64_t>(seed)});
      const double q = watched(system, {{216}}, 12).back().q;
      sum += q / kSeeds;
      squares += q * q / kSeeds;
    }
    EXPECT_LT(std::sqrt(squares - sum * sum), 0.04 * sum) << state.X0 << " " << state.phi;
    EXPECT_NEAR(sum, state.q, 0.06 * state.q) << state.X0 << " " << state.phi;
  }
}

TEST(Equilibration, OfBodiesThatStayIsNever) {
  ed::System system = ed_test::grid(ed_test::species(2, Inertia::paper), 4, 4);
  for (ed::Body& body : system.bodies) body.velocity = {1e-6, 0, 0};
  const std::vector<ed::Relaxation> states = watched(system, {{64}}, 20);
  EXPECT_EQ(states.back().relaxations, 0);
  EXPECT_FALSE(states.back().reached);
  EXPECT_NEAR(states.back().f_self, 1, 1e-6);
  EXPECT_NEAR(states.back().c2, 1, 1e-12);
}

TEST(Equilibration, OfFreeFlightIsThatOfPositionsAlone) {
  // C2 of free rotors falls to 1/4 and stays; bodies that are said not to turn have only positions to forget.
  const ed::System system = ed_test::maxwellian_gas(ed_test::species(3, Inertia::paper), 8, 100, 2);
  const ed::Relaxation turning = watched(system, {{512, true}}, 30).back();
  EXPECT_EQ(turning.relaxations, 0);
  EXPECT_NEAR(turning.c2, 0.25, 0.1);
  EXPECT_LT(turning.f_self, 0.05);
  const ed::Relaxation not_turning = watched(system, {{512, false}}, 9).back();
  EXPECT_TRUE(not_turning.reached);
  EXPECT_TRUE(std::isnan(not_turning.c2));
  // The slowest group is what counts.
  EXPECT_EQ(watched(system, {{500, false}, {12, true}}, 9).back().relaxations, 0);
}

TEST(Equilibration, WaitsWhileTheOrderDrifts) {
  // Positions are forgotten at once; axes that were aligned part slowly, S falling from 1 to 1/4 in some 60 time units.
  ed::System system = ed_test::maxwellian_gas(ed_test::species(3, Inertia::paper), 8, 100, 3);
  for (ed::Body& body : system.bodies) {
    const Eigen::Vector3d omega = body.rotation.transpose() * body.angular_velocity;
    body.rotation.setIdentity();
    body.angular_velocity = 0.01 * omega;
  }
  const std::vector<ed::Relaxation> states = watched(system, {{512, false}}, 160);
  EXPECT_EQ(states[7].relaxations, 2);
  EXPECT_FALSE(states[7].reached);
  EXPECT_FALSE(states[15].reached);
  EXPECT_LT(states[15].S_change, -0.05);
  EXPECT_TRUE(states.back().reached);
}

TEST(Equilibration, GoesOnFromItsBytes) {
  const ed::System system = ed_test::start({2, 0.3, 64, Inertia::paper, 4});
  const std::vector<ed::RelaxingGroup> groups = {{40, true}, {24, true}};
  ed::Simulation simulation(system);
  ed::EquilibrationMonitor straight(simulation, groups);
  ed::EquilibrationMonitor restored(simulation, groups);
  for (int k = 1; k <= 30; ++k) {
    simulation.run_until(k);
    straight.measure(simulation);
    restored = ed::EquilibrationMonitor::restore(restored.save(), groups);
    restored.measure(simulation);
    ASSERT_TRUE(restored.save() == straight.save()) << k;
  }
  EXPECT_GT(straight.state().relaxations, 1);
  const std::string state = straight.save();
  const auto refused = [&](const std::string& bytes, const std::vector<ed::RelaxingGroup>& those) {
    return test_common::message_of([&] { ed::EquilibrationMonitor::restore(bytes, those); });
  };
  EXPECT_THAT(refused(state, {{63}}), testing::StartsWith("state: "));
  EXPECT_THAT(refused(state + "x", groups), testing::StartsWith("state: "));
  for (std::size_t length = 0; length < state.size(); length += 1 + length / 50) {
    EXPECT_THAT(refused(state.substr(0, length), groups), testing::StartsWith("state: ")) << length;
  }
}

TEST(Equilibration, GroupsHaveToBeGroupsOfTheBodies) {
  const ed::System system = ed_test::grid(ed_test::species(2, Inertia::paper), 3, 10);
  const ed::Simulation simulation(system);
  using Groups = std::vector<ed::RelaxingGroup>;
  for (const Groups& groups :
       {Groups{}, Groups{{26}}, Groups{{28}}, Groups{{27}, {1}}, Groups{{27}, {0}}, Groups{{-1}, {28}}}) {
    EXPECT_THROW(ed::EquilibrationMonitor(simulation, groups), std::invalid_argument);
  }
}

}  // namespace
