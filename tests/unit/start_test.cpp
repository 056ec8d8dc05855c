// Starts: no overlap, exact packing fraction, temperatures and momentum; and what cannot be started is refused.

#include <common/ed_hash.h>
#include <common/ed_states.h>

#include <ed/ed.h>

#include <Eigen/LU>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using ed_test::Inertia;
using ed_test::State;
using testing::HasSubstr;

/// Sums over some hundred bodies, each term rounded.
constexpr double kRounding = 1e-12;

std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no std::invalid_argument";
}

double spin_kT(const ed::System& system) {
  return 2 * ed::kinetic_state(system).spin_energy / system.size();
}

class Start : public testing::TestWithParam<State> {};

TEST_P(Start, HasNoOverlapAndExactTemperatures) {
  const State& state = GetParam();
  const ed::System system = ed_test::start(state);
  ASSERT_EQ(system.size(), state.number);
  EXPECT_NEAR(ed::packing_fraction(system) / state.packing_fraction, 1, 1e-14);

  const ed::Audit audit = ed::audit(system);
  EXPECT_TRUE(audit.finite);
  EXPECT_EQ(audit.overlaps, 0);
  EXPECT_EQ(audit.unanswered, 0);
  EXPECT_GE(audit.minimum_distance, -ed::kAuditOverlap);

  const ed::KineticState kinetic = ed::kinetic_state(system);
  EXPECT_NEAR(kinetic.translational_kT, 1, kRounding);
  EXPECT_NEAR(kinetic.rotational_kT, 1, kRounding);
  EXPECT_NEAR(kinetic.momentum.norm(), 0, kRounding);
  if (state.inertia == Inertia::uniform) {
    EXPECT_NEAR(spin_kT(system), 1, kRounding);
  } else {
    EXPECT_NEAR(spin_kT(system), 0, kRounding);
  }
  for (const ed::Body& body : system.bodies) {
    EXPECT_LE(body.position.cwiseAbs().maxCoeff(), 0.5 * system.box * (1 + 1e-15));
    EXPECT_LE((body.rotation.transpose() * body.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_GT(body.rotation.determinant(), 0);
  }
}

std::vector<State> starts() {
  return {{1.0 / 3, 0.40, 64, Inertia::paper, 1}, {0.5, 0.30, 64, Inertia::uniform, 2},
          {1, 0.50, 64, Inertia::uniform, 3},     {1.5, 0.50, 64, Inertia::paper, 4},
          {2, 0.02, 64, Inertia::paper, 5},       {3, 0.40, 72, Inertia::uniform, 6},
          {5, 0.10, 64, Inertia::paper, 7}};
}

INSTANTIATE_TEST_SUITE_P(Fluids, Start, testing::ValuesIn(starts()),
                         [](const testing::TestParamInfo<State>& suite) { return std::to_string(suite.index); });

TEST(RandomStart, SameSeedGivesTheSameBits) {
  const State state{2, 0.30, 48, Inertia::uniform, 11};
  State other = state;
  other.seed = 12;
  const std::uint64_t hash = ed_test::hash_of(ed_test::start(state));
  EXPECT_EQ(ed_test::hash_of(ed_test::start(state)), hash);
  EXPECT_NE(ed_test::hash_of(ed_test::start(other)), hash);
}

TEST(RandomStart, IsIsotropic) {
  const ed::System system = ed_test::start({3, 0.01, 2000, Inertia::paper, 13});
  std::vector<Eigen::Vector3d> axes;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const ed::Body& body : system.bodies) {
    axes.emplace_back(body.rotation.col(2));
    mean += body.rotation.col(2) / system.size();
  }
  // Elements of Q have standard deviation about 1 / sqrt(5 N) = 0.01; components of the mean 1 / sqrt(3 N) = 0.013.
  EXPECT_LT(ed::nematic_order(axes), 0.05);
  EXPECT_LT(mean.norm(), 4 * 0.013 * std::sqrt(3.0));
}

TEST(RandomStart, SmallestNumberWorksAndOneLessIsRefused) {
  for (const State& state : {State{1, 0.40, 0, Inertia::paper, 14}, State{0.5, 0.35, 0, Inertia::paper, 15},
                             State{3, 0.40, 0, Inertia::paper, 16}}) {
    const int least = ed::smallest_number(ed_test::spheroid(state.aspect_ratio), state.packing_fraction);
    State smallest = state;
    smallest.number = least;
    ed::System system = ed_test::start(smallest);
    EXPECT_EQ(ed::audit(system).overlaps, 0) << ed_test::describe(smallest);
    ed::Simulation simulation(system);
    simulation.run_collisions(1000);
    EXPECT_EQ(ed::audit(simulation.system()).overlaps, 0) << ed_test::describe(smallest);
    EXPECT_EQ(simulation.counters().overlaps, 0U);

    smallest.number = least - 1;
    const std::string message = message_of([&] { (void)ed_test::start(smallest); });
    EXPECT_THAT(message, HasSubstr("number is " + std::to_string(least - 1)));
    EXPECT_THAT(message, HasSubstr("box"));
    EXPECT_THAT(message, HasSubstr("at least " + std::to_string(least)));
  }
}

TEST(RandomStart, RefusesImpossiblePackingFractions) {
  const double densest = ed::densest_start(ed_test::spheroid(2));
  for (const double phi : {0.0, -0.1, densest + 1e-9, 1.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(message_of([&] { (void)ed_test::start({2, phi, 64}); }), HasSubstr("packing_fraction")) << phi;
  }
}

TEST(RandomStart, RefusesNumbersThatAreNone) {
  for (const int number : {0, -1, 1}) {
    EXPECT_THAT(message_of([&] { (void)ed_test::start({1, 0.01, number}); }), HasSubstr("number")) << number;
  }
}

TEST(RandomStart, RefusesThreeDifferentSemiAxes) {
  for (const bool spins : {false, true}) {
    ed::Species biaxial;
    biaxial.shape = geom::Ellipsoid({1, 2, 3});
    biaxial.spins = spins;
    EXPECT_THAT(message_of([&] { (void)ed::random_start(biaxial, {64, 0.01, 1, {}}); }), HasSubstr("semi_axes"));
  }
  EXPECT_THROW((void)ed::paper_species(geom::Ellipsoid({1, 2, 3})), std::invalid_argument);
  EXPECT_THROW((void)ed::uniform_species(geom::Ellipsoid({1, 2, 3})), std::invalid_argument);
}

TEST(RandomStart, TellsItsProgressAndStopsWhenAsked) {
  ed::StartOptions options;
  options.number = 64;
  options.packing_fraction = 0.45;
  double last = 0;
  int calls = 0;
  options.progress = [&](double phi) {
    EXPECT_GE(phi, last);
    EXPECT_LE(phi, 0.45 * (1 + 1e-12));
    last = phi;
    ++calls;
    return true;
  };
  const ed::Species species = ed_test::species(2, Inertia::paper);
  (void)ed::random_start(species, options);
  EXPECT_GT(calls, 0);
  options.progress = [](double) { return false; };
  EXPECT_THROW((void)ed::random_start(species, options), std::runtime_error);
}

TEST(DensestStart, IsBelowRandomClosePacking) {
  for (const double X0 : {0.1, 0.5, 0.9, 1.0, 1.1, 2.0, 10.0}) {
    const double densest = ed::densest_start(ed_test::spheroid(X0));
    EXPECT_GT(densest, 0.6) << X0;
    EXPECT_LT(densest, X0 == 1 ? 0.64 : 0.71) << X0;
  }
}

TEST(RescaleVelocities, SetsEachTemperatureAndTheMomentum) {
  ed::System system = ed_test::grid(ed_test::species(3, Inertia::uniform), 4, 10);
  ed::Random random(17);
  for (ed::Body& body : system.bodies) {
    body.rotation = random.rotation();
    body.velocity = Eigen::Vector3d(5, 0, 0) + 3 * random.normal3();
    body.angular_velocity = 0.1 * random.normal3();
  }
  const ed::System before = system;
  ed::rescale_velocities(system);
  const ed::KineticState kinetic = ed::kinetic_state(system);
  EXPECT_NEAR(kinetic.translational_kT, 1, kRounding);
  EXPECT_NEAR(kinetic.rotational_kT, 1, kRounding);
  EXPECT_NEAR(spin_kT(system), 1, kRounding);
  EXPECT_NEAR(kinetic.momentum.norm(), 0, kRounding);
  // One factor for all bodies: ratios of spins stay.
  const auto spin = [](const ed::Body& body) { return body.angular_velocity.dot(body.rotation.col(2)); };
  EXPECT_NEAR(spin(system.bodies[1]) / spin(system.bodies[0]), spin(before.bodies[1]) / spin(before.bodies[0]), 1e-10);
}

TEST(RescaleVelocities, LeavesBodiesAtRestAtRest) {
  ed::System system = ed_test::grid(ed_test::species(3, Inertia::uniform), 2, 10);
  ed::rescale_velocities(system);
  for (const ed::Body& body : system.bodies) {
    EXPECT_EQ(body.velocity, Eigen::Vector3d::Zero());
    EXPECT_EQ(body.angular_velocity, Eigen::Vector3d::Zero());
  }
}

}  // namespace
