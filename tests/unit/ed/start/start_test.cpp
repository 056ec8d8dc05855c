// Starts: no overlap, exact packing fraction, temperatures and momentum; and what cannot be started is refused.

#include <common/ed/hash.h>
#include <common/ed/start_checks.h>
#include <common/ed/states.h>
#include <common/message_of.h>

#include <ed/ed.h>

#include <Eigen/LU>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using ed_test::expect_sound;
using ed_test::Inertia;
using ed_test::kRounding;
using ed_test::maier_saupe_fourth_moment;
using ed_test::order_about_z;
using ed_test::spin_kT;
using ed_test::State;
using test_common::message_of;
using testing::HasSubstr;

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

TEST(RandomStart, RefusesSpeciesThatAreNone) {
  EXPECT_THROW((void)ed::paper_species(geom::Ellipsoid({1, 2, 3})), std::invalid_argument);
  ed::Species impossible = ed::uniform_species(geom::Ellipsoid({1, 2, 3}));
  impossible.inertia = {1, 1, 2.1};
  EXPECT_THAT(message_of([&] { (void)ed::random_start(impossible, {64, 0.01, 1, {}}); }), HasSubstr("inertia"));
  const ed::Species sphere = ed::uniform_species(geom::Ellipsoid({1, 1, 1}));
  EXPECT_THAT(message_of([&] {
                (void)ed::random_start({{sphere, 64}, {sphere, 0}}, {64, 0.01, 1, {}});
              }),
              HasSubstr("number of bodies of species 2 is 0"));
  EXPECT_THAT(message_of([&] {
                (void)ed::random_start(std::vector<ed::Component>{}, {64, 0.01, 1, {}});
              }),
              HasSubstr("species: none"));
}

/// Compressed with their own masses the heavy ones hardly move while the light ones collide.
TEST(RandomStart, MassesThatDifferByMuchCostNothing) {
  ed::StartOptions options;
  options.packing_fraction = 0.4;
  std::vector<ed::Component> components(2, {ed::uniform_species(ed_test::spheroid(2)), 50});
  const double masses[] = {1e6, 1e-6};
  for (std::size_t k = 0; k < 2; ++k) {
    components[k].species.mass *= masses[k];
    components[k].species.inertia *= masses[k];
  }
  const ed::System system = ed::random_start(components, options);
  expect_sound(system, 0.4);
  double twice_energy[2] = {0, 0};
  for (const ed::Body& body : system.bodies) {
    const auto k = static_cast<std::size_t>(body.species);
    EXPECT_EQ(system.species[k].mass, components[k].species.mass);
    EXPECT_EQ(system.species[k].inertia, components[k].species.inertia);
    twice_energy[k] += masses[k] * body.velocity.squaredNorm();
  }
  // Momentum zero takes its three degrees of freedom from the heavy ones.
  EXPECT_NEAR(twice_energy[0] / 147, 1, 1e-11);
  EXPECT_NEAR(twice_energy[1] / 150, 1, 1e-11);
}

/// Compresses so few spheres that they jam now and then below the densest start.
TEST(RandomStart, SaysWhereItGotStuck) {
  const ed::Species sphere = ed::paper_species(geom::Ellipsoid({1, 1, 1}));
  ed::StartOptions options;
  options.packing_fraction = ed::densest_start(sphere.shape);
  int stuck = 0;
  for (options.seed = 1; options.seed <= 6; ++options.seed) {
    try {
      expect_sound(ed::random_start(std::vector<ed::Component>{{sphere, 40}}, options), options.packing_fraction);
    } catch (const std::runtime_error& error) {
      ++stuck;
      EXPECT_THAT(error.what(), HasSubstr("packing_fraction: the compression got stuck at 0.61"));
      EXPECT_THAT(error.what(),
                  HasSubstr(" of 0.62; a lower value is needed for this shape, or another seed, or more bodies"));
    }
  }
  EXPECT_GT(stuck, 0);
  EXPECT_LT(stuck, 6);
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

TEST(Compressed, GoesOnFromAStateToADenserOne) {
  const ed::System dilute = ed_test::start({3, 0.20, 100, Inertia::uniform, 17});
  double last = 0;
  const ed::System dense = ed::compressed(dilute, 0.35, [&](double phi) {
    EXPECT_GE(phi, last);
    last = phi;
    return true;
  });
  EXPECT_NEAR(last, 0.35, 1e-12);
  EXPECT_NEAR(ed::packing_fraction(dense) / 0.35, 1, 1e-14);
  const ed::Audit audit = ed::audit(dense);
  EXPECT_EQ(audit.overlaps, 0);
  EXPECT_EQ(audit.unanswered, 0);
  const ed::KineticState kinetic = ed::kinetic_state(dense);
  EXPECT_NEAR(kinetic.translational_kT, 1, kRounding);
  EXPECT_NEAR(kinetic.rotational_kT, 1, kRounding);
  EXPECT_NEAR(kinetic.momentum.norm(), 0, kRounding);
  EXPECT_NEAR(spin_kT(dense), 1, kRounding);
  EXPECT_EQ(ed_test::hash_of(ed::compressed(dilute, 0.35)), ed_test::hash_of(dense));
}

TEST(Compressed, LeavesAStateOfTheSamePackingFractionWhereItIs) {
  const ed::System state = ed_test::start({2, 0.20, 64, Inertia::paper, 18});
  const ed::System same = ed::compressed(state, 0.20);
  EXPECT_EQ(same.box, state.box);
  for (std::size_t k = 0; k < state.bodies.size(); ++k) {
    EXPECT_EQ(same.bodies[k].position, state.bodies[k].position);
    EXPECT_EQ(same.bodies[k].rotation, state.bodies[k].rotation);
  }
}

TEST(Compressed, RefusesWhatCannotBeReached) {
  const ed::System state = ed_test::start({2, 0.20, 64, Inertia::paper, 19});
  for (const double phi : {0.0, 0.19, 0.7, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(message_of([&] { (void)ed::compressed(state, phi); }), HasSubstr("packing_fraction is ")) << phi;
  }
  const ed::System few = ed_test::start({5, 0.10, 64, Inertia::paper, 7});
  EXPECT_THAT(message_of([&] { (void)ed::compressed(few, 0.5); }), HasSubstr("number: a box"));
  EXPECT_THROW((void)ed::compressed(state, 0.3, [](double) { return false; }), std::runtime_error);
}

TEST(NematicStart, HasTheOrderParameterWhereNothingIsCompressed) {
  for (const double S : {0.0, 0.2, 0.5, 0.8, 0.97}) {
    ed::StartOptions options{2000, 0.02, 21, {}};
    options.nematic_order = S;
    const ed::System system = ed::random_start(ed_test::species(3, Inertia::paper), options);
    EXPECT_EQ(ed::audit(system).overlaps, 0);
    // Four standard errors: that of P2 is at most 0.45 (at S = 0; about 0.4 at S = 0.5) and about 1 - S at S near 1.
    EXPECT_NEAR(order_about_z(system, 2), S, 4 * std::min(0.47, 1.1 * (1 - S)) / std::sqrt(2000.0)) << S;
    // Heads and tails alike, and no direction about z preferred.
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const ed::Body& body : system.bodies) mean += body.rotation.col(2) / system.size();
    EXPECT_LT(mean.norm(), 4 / std::sqrt(2000.0)) << S;
    for (const ed::Body& body : system.bodies) {
      ASSERT_LE((body.rotation.transpose() * body.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14);
      ASSERT_GT(body.rotation.determinant(), 0);
    }
  }
}

TEST(NematicStart, IsMaierAndSaupes) {
  ed::StartOptions options{20000, 0.001, 22, {}};
  options.nematic_order = 0.6;
  const ed::System system = ed::random_start(ed_test::species(1, Inertia::paper), options);
  double fourth = 0;
  for (const ed::Body& body : system.bodies) fourth += std::pow(body.rotation(2, 2), 4) / system.size();
  // x^4 has a standard deviation of at most 0.5 on [0, 1].
  EXPECT_NEAR(fourth, maier_saupe_fourth_moment(0.6), 4 * 0.5 / std::sqrt(20000.0));
}

TEST(NematicStart, RefusesOrdersThatAreNone) {
  for (const double S : {-0.1, 1.0, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
    ed::StartOptions options{64, 0.02, 1, {}};
    options.nematic_order = S;
    EXPECT_THAT(message_of([&] { (void)ed::random_start(ed_test::species(3, Inertia::paper), options); }),
                HasSubstr("nematic_order"));
    EXPECT_THAT(message_of([&] {
                  (void)ed::lattice_start({{ed_test::species(3, Inertia::paper), 288}},
                                          {.packing_fraction = 0.1, .nematic_order = S});
                }),
                HasSubstr("nematic_order"));
  }
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

TEST(RescaleVelocities, KeepsTheRotationOfSpheresApart) {
  // It exchanges energy with nothing: on it alone kT must be 1.
  ed::System system = ed_test::grid(ed_test::species(3, Inertia::uniform), 3, 10);
  system.species.push_back(ed_test::species(1, Inertia::paper));
  ed::Random random(18);
  for (int i = 0; i < system.size(); ++i) {
    ed::Body& body = system.bodies[static_cast<std::size_t>(i)];
    body.species = i % 2;
    body.rotation = random.rotation();
    body.velocity = random.normal3();
    body.angular_velocity = (1 + i % 2) * (body.rotation * Eigen::Vector3d(random.normal(), random.normal(), 0));
  }
  ed::rescale_velocities(system);
  for (const int kind : {0, 1}) {
    ed::System part = system;
    std::erase_if(part.bodies, [&](const ed::Body& body) { return body.species != kind; });
    EXPECT_NEAR(ed::kinetic_state(part).rotational_kT, 1, kRounding) << kind;
  }
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
