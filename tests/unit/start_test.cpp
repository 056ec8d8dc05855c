// Starts: no overlap, exact packing fraction, temperatures and momentum; and what cannot be started is refused.

#include <common/ed_hash.h>
#include <common/ed_states.h>
#include <common/geom_shapes.h>
#include <common/message_of.h>

#include <ed/ed.h>

#include <Eigen/LU>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using ed_test::Inertia;
using ed_test::State;
using test_common::message_of;
using testing::HasSubstr;

/// Sums over some hundred bodies, each term rounded.
constexpr double kRounding = 1e-12;

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

void expect_sound(const ed::System& system, double packing_fraction) {
  EXPECT_NEAR(ed::packing_fraction(system) / packing_fraction, 1, 1e-14);
  const ed::Audit audit = ed::audit(system);
  EXPECT_TRUE(audit.finite);
  EXPECT_EQ(audit.overlaps, 0);
  EXPECT_GT(audit.minimum_distance, 0);
  EXPECT_NEAR(audit.kinetic.translational_kT, 1, kRounding);
  EXPECT_NEAR(audit.kinetic.rotational_kT, 1, kRounding);
  EXPECT_NEAR(audit.kinetic.momentum.norm(), 0, kRounding);
  for (const ed::Body& body : system.bodies) ASSERT_LE(body.position.cwiseAbs().maxCoeff(), 0.5 * system.box);
  ed::Simulation simulation(system);
  simulation.run_collisions(2000);
  EXPECT_EQ(simulation.counters().overlaps, 0U);
  EXPECT_EQ(ed::audit(simulation.system()).overlaps, 0);
}

/// How many have a copy half a box away in x, as old as they are, but of another velocity.
int copies_half_a_box_away(const ed::System& system) {
  int copies = 0;
  for (const ed::Body& a : system.bodies) {
    for (const ed::Body& b : system.bodies) {
      Eigen::Vector3d d = b.position - a.position - Eigen::Vector3d(0.5 * system.box, 0, 0);
      d -= system.box * (d / system.box).array().round().matrix();
      if (d.norm() > 1e-12 * system.box) continue;
      ++copies;
      EXPECT_TRUE(a.rotation == b.rotation);
      EXPECT_FALSE(a.velocity == b.velocity);
      EXPECT_FALSE(a.angular_velocity == b.angular_velocity);
    }
  }
  return copies;
}

/// 1001 bodies, of boxes of 130 at most.
ed::System large_start(double packing_fraction) {
  ed::StartOptions options;
  options.number = 1001;
  options.packing_fraction = packing_fraction;
  options.most_compressed = 130;
  ed::System system = ed::random_start(ed::paper_species(ed_test::spheroid(0.6)), options);
  EXPECT_EQ(system.size(), 1001);
  expect_sound(system, packing_fraction);
  return system;
}

TEST(RandomStart, LargeOnesAreRepeated) {
  const ed::System system = large_start(0.3);
  // 126 bodies to each of 8 boxes, 7 of the 1008 taken out: nearly all have a copy.
  const int copies = copies_half_a_box_away(system);
  EXPECT_GE(copies, 1001 - 7);
  EXPECT_LE(copies, 1001);
}

TEST(RandomStart, DiluteOnesAreNotRepeated) {
  EXPECT_EQ(copies_half_a_box_away(large_start(0.03)), 0);
}

TEST(RandomStart, LargeMixturesAreRepeated) {
  ed::StartOptions options;
  options.packing_fraction = 0.3;
  options.most_compressed = 150;
  const std::vector<ed::Component> components = {{ed::paper_species(ed_test::spheroid(2)), 700},
                                                 {ed::uniform_species(ed_test::spheroid(0.8)), 303}};
  const ed::System system = ed::random_start(components, options);
  ASSERT_EQ(system.size(), 1003);
  for (int i = 0; i < system.size(); ++i) {
    EXPECT_EQ(system.bodies[static_cast<std::size_t>(i)].species, i < 700 ? 0 : 1) << i;
  }
  expect_sound(system, 0.3);
}

TEST(RandomStart, ManySpeciesAreNotRepeated) {
  ed::StartOptions options;
  options.packing_fraction = 0.1;
  options.most_compressed = 20;
  std::vector<ed::Component> components;
  for (int k = 0; k < 300; ++k) components.push_back({ed::paper_species(ed_test::spheroid(1 + 0.001 * k)), 1});
  const ed::System system = ed::random_start(components, options);
  ASSERT_EQ(system.size(), 300);
  expect_sound(system, 0.1);
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

/// <P2> of the body axis about z.
double order_about_z(const ed::System& system, int axis) {
  double sum = 0;
  for (const ed::Body& body : system.bodies) sum += 1.5 * body.rotation(2, axis) * body.rotation(2, axis) - 0.5;
  return sum / system.size();
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

/// <x^4>, x = cos(theta), by quadrature with the m that gives this <P2(x)>.
double maier_saupe_fourth_moment(double order) {
  const auto moment = [](double m, int k) {
    double sum = 0;
    for (int i = 0; i < 20000; ++i)
      sum += std::pow((i + 0.5) / 20000, k) * std::exp(m * std::pow((i + 0.5) / 20000, 2));
    return sum;
  };
  double low = 0;
  double high = 50;
  for (int i = 0; i < 50; ++i) {
    const double m = 0.5 * (low + high);
    (1.5 * moment(m, 2) / moment(m, 0) - 0.5 < order ? low : high) = m;
  }
  return moment(low, 4) / moment(low, 0);
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

ed::System lattice(const ed::Species& species, int number, const ed::LatticeOptions& options) {
  return ed::lattice_start({{species, number}}, options);
}

TEST(LatticeStart, HoldsWhatTheClosestPackingOfSpheresDoes) {
  // pi / sqrt(18) = 0.740480, of spheres in cubic cells and of ellipsoids in cells of their proportions.
  const ed::Species discs = ed::uniform_species(geom::Ellipsoid({2, 2, 1}));
  const ed::Species biaxial = ed::uniform_species(geom::Ellipsoid({3, 1.5, 1}));
  const std::vector<std::pair<ed::Species, int>> fits = {{ed_test::species(1, Inertia::paper), 4 * 5 * 5 * 5},
                                                         {ed_test::species(3, Inertia::paper), 4 * 9 * 9 * 3},
                                                         {discs, 4 * 4 * 4 * 8},
                                                         {biaxial, 4 * 3 * 6 * 9}};
  for (const auto& [species, number] : fits) {
    expect_sound(lattice(species, number, {.packing_fraction = 0.7404}), 0.7404);
    const std::string message =
        message_of([&, &s = species, n = number] { (void)lattice(s, n, {.packing_fraction = 0.75}); });
    EXPECT_THAT(message, HasSubstr("packing_fraction is 0.75"));
    EXPECT_THAT(message, HasSubstr("at most 0.7404")) << ed::describe(species.shape);
  }
}

TEST(LatticeStart, StacksSuperballsOnTheSimpleCubicLattice) {
  const ed::Species superball = ed::uniform_species(geom::Superellipsoid({1, 1, 1}, 0.5, 0.5));
  // In cubes of edge 2.
  const double densest = ed::volume(superball.shape) / 8;
  const double below = std::floor(1e4 * densest) / 1e4;
  const ed::LatticeOptions cubic{.lattice = ed::Lattice::simple_cubic, .packing_fraction = below};
  expect_sound(lattice(superball, 512, cubic), below);
  ed::LatticeOptions denser = cubic;
  denser.packing_fraction = below + 2e-4;
  std::ostringstream limit;
  limit << "at most " << below;
  EXPECT_THAT(message_of([&] { (void)lattice(superball, 512, denser); }), HasSubstr(limit.str()));
}

TEST(LatticeStart, TakesUsersShapes) {
  // Spherocylinders of total length 4 and diameter 1, aligned in layers.
  const double volume = std::numbers::pi * (3 * 0.25 + 1.0 / 6);
  const ed::CustomShape rod(geom_test::Spherocylinder{1.5, 0.5}, {"spherocylinder", volume, 2, true});
  const ed::Species rods{rod, 1, {1, 1, 0.1}, true};
  expect_sound(lattice(rods, 8 * 8 * 2, {.lattice = ed::Lattice::simple_cubic, .packing_fraction = 0.5}), 0.5);
  expect_sound(lattice(rods, 4 * 8 * 8 * 2, {.packing_fraction = 0.5}), 0.5);
}

TEST(LatticeStart, PutsTheAxisAskedForAlongZ) {
  const ed::Species biaxial = ed::uniform_species(geom::Ellipsoid({3, 1.5, 1}));
  for (const int axis : {0, 1, 2}) {
    const ed::System system = lattice(biaxial, 4 * 3 * 6 * 9, {.packing_fraction = 0.5, .axis = axis});
    for (const ed::Body& body : system.bodies) ASSERT_EQ(body.rotation.col(axis), Eigen::Vector3d::UnitZ());
    expect_sound(system, 0.5);
  }
  EXPECT_THAT(message_of([&] { (void)lattice(biaxial, 648, {.axis = 3}); }), HasSubstr("axis is 3"));
}

TEST(LatticeStart, NamesTheNumbersThatHold) {
  const ed::Species species = ed_test::species(3, Inertia::paper);
  for (const int number : {501, 512, 600}) {
    const std::string message = message_of([&] { (void)lattice(species, number, {.packing_fraction = 0.65}); });
    const std::size_t at = message.find(number % 4 == 0 ? "a number of " : "accepted: ");
    ASSERT_NE(at, std::string::npos) << message;
    const std::size_t digit = message.find_first_of("0123456789", at);
    const int nearest = std::stoi(message.substr(digit));
    expect_sound(lattice(species, nearest, {.packing_fraction = 0.65}), 0.65);
  }
  EXPECT_THAT(message_of([&] { (void)lattice(species, 501, {.packing_fraction = 0.3}); }),
              HasSubstr("number is 501: the fcc lattice has 4 bodies in a cell; accepted: 480 or 504"));
  EXPECT_THAT(message_of([&] { (void)lattice(species, 4, {.packing_fraction = 0.3}); }), HasSubstr("number"));
}

TEST(LatticeStart, RefusesImpossiblePackingFractions) {
  for (const double phi : {0.0, -0.1, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(message_of([&] { (void)lattice(ed_test::species(3, Inertia::paper), 288, {.packing_fraction = phi}); }),
                HasSubstr("packing_fraction is"));
  }
}

TEST(LatticeStart, NematicOrderIsThatOfTheStart) {
  const ed::Species species = ed_test::species(3, Inertia::paper);
  for (const auto& [phi, S] : {std::pair(0.05, 0.0), std::pair(0.2, 0.5), std::pair(0.4, 0.8), std::pair(0.6, 0.98)}) {
    const ed::System system = lattice(species, 288, {.packing_fraction = phi, .nematic_order = S});
    EXPECT_EQ(ed::audit(system).overlaps, 0);
    EXPECT_NEAR(ed::packing_fraction(system) / phi, 1, 1e-14);
    // Never below; above by what one body's turn changes, or, without an order, by three errors of a sample.
    EXPECT_GE(order_about_z(system, 2), S - kRounding);
    EXPECT_LT(order_about_z(system, 2), S + (S == 0 ? 3 * 0.45 / std::sqrt(288.0) : 0.02)) << phi << " " << S;
    // The director stays along z: the bodies did not turn together.
    std::vector<Eigen::Vector3d> axes;
    for (const ed::Body& body : system.bodies) axes.emplace_back(body.rotation.col(2));
    // Of a tilt q of the order tensor the largest eigenvalue is larger by about q^2 / (1.5 S), q up to 1 / sqrt(288).
    if (S > 0) {
      EXPECT_NEAR(ed::nematic_order(axes), order_about_z(system, 2), 0.02) << phi << " " << S;
    }
  }
}

TEST(LatticeStart, FreeBodiesHaveMaierAndSaupesOrientations) {
  // Spheres turn without meeting: the fourth moment is that of the distribution with the same second one.
  const ed::System system =
      lattice(ed_test::species(1, Inertia::paper), 4000, {.packing_fraction = 0.3, .nematic_order = 0.6});
  double fourth = 0;
  for (const ed::Body& body : system.bodies) fourth += std::pow(body.rotation(2, 2), 4) / system.size();
  EXPECT_NEAR(fourth, maier_saupe_fourth_moment(0.6), 4 * 0.5 / std::sqrt(4000.0));
}

TEST(LatticeStart, RefusesOrdersThatBodiesDoNotTurnTo) {
  const ed::Species species = ed_test::species(3, Inertia::paper);
  const auto refused = [&](double S) {
    return message_of([&] { (void)lattice(species, 288, {.packing_fraction = 0.6, .nematic_order = S}); });
  };
  const std::string message = refused(0.5);
  EXPECT_THAT(message, HasSubstr("nematic_order is 0.5"));
  // The value named is accepted.
  EXPECT_EQ(refused(std::stod(message.substr(message.find("at least ") + 9))), "no std::invalid_argument");
}

TEST(LatticeStart, MixturesStandAnywhere) {
  std::vector<ed::Component> components;
  for (const double size : {0.9, 1.0, 1.1})
    components.push_back({ed::scaled(ed_test::species(2, Inertia::paper), size), 144});
  const ed::System system = ed::lattice_start(components, {.packing_fraction = 0.4});
  ASSERT_EQ(system.size(), 432);
  expect_sound(system, 0.4);
  // In the order of their components, but not so in space: a species alone in its third would have mean |z| of 1/3 L.
  double z = 0;
  for (int i = 0; i < 144; ++i) z += system.bodies[static_cast<std::size_t>(i)].position.z() / 144;
  EXPECT_EQ(system.bodies[143].species, 0);
  EXPECT_LT(std::abs(z), 4 * system.box / std::sqrt(12.0 * 144));
  const std::string message = message_of([&] { (void)ed::lattice_start(components, {.packing_fraction = 0.72}); });
  const double most = std::stod(message.substr(message.find("at most ") + 8));
  EXPECT_LT(most, 0.72);
  expect_sound(ed::lattice_start(components, {.packing_fraction = most}), most);
}

TEST(LatticeStart, SameSeedGivesTheSameBits) {
  const ed::Species species = ed_test::species(3, Inertia::uniform);
  ed::LatticeOptions options{.packing_fraction = 0.2, .seed = 31, .nematic_order = 0.5};
  const std::uint64_t hash = ed_test::hash_of(lattice(species, 288, options));
  EXPECT_EQ(ed_test::hash_of(lattice(species, 288, options)), hash);
  options.seed = 32;
  EXPECT_NE(ed_test::hash_of(lattice(species, 288, options)), hash);
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
