// Starts on a lattice: which numbers and packing fractions hold, orders, mixtures; and what is refused.

#include <common/ed/hash.h>
#include <common/ed/start_checks.h>
#include <common/ed/states.h>
#include <common/full_form.h>
#include <common/geom/shapes.h>
#include <common/message_of.h>

#include <ed/ed.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using ed_test::expect_sound;
using ed_test::Inertia;
using ed_test::kRounding;
using ed_test::maier_saupe_fourth_moment;
using ed_test::order_about_z;
using test_common::message_of;
using testing::HasSubstr;

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

/// The numbers that a message names after `words`.
std::vector<int> numbers_after(const std::string& message, const std::string& words) {
  const std::size_t at = message.find(words);
  if (at == std::string::npos) return {};
  std::istringstream text(message.substr(at + words.size()));
  std::vector<int> numbers(1);
  std::string word;
  text >> numbers[0] >> word;
  if (word == "or") text >> numbers.emplace_back();
  return numbers;
}

/// Rods of sizes from 0.8 to 1.2, evenly.
std::vector<ed::Component> rods_of_many_sizes(int number) {
  std::vector<ed::Component> components;
  components.reserve(static_cast<std::size_t>(number));
  for (int k = 0; k < number; ++k)
    components.push_back({ed::scaled(ed_test::species(3, Inertia::paper), 0.8 + 0.4 * k / number), 1});
  return components;
}

TEST(LatticeStart, NamesTheNumbersThatFillWellForMixtures) {
  const auto two_sizes = [](int number) {
    const ed::Species rod = ed_test::species(3, Inertia::paper);
    return std::vector<ed::Component>{{rod, number / 2}, {ed::scaled(rod, 0.9), number - number / 2}};
  };
  for (const auto& components : {+[](int n) { return rods_of_many_sizes(n); }, +two_sizes}) {
    const auto refusal = [&](int number, double phi) {
      return message_of([&] { (void)ed::lattice_start(components(number), {.packing_fraction = phi}); });
    };
    const double most = std::stod(refusal(512, 0.7).substr(refusal(512, 0.7).find("at most ") + 8));
    const std::string message = refusal(512, 1.1 * most);
    const std::vector<int> enough = numbers_after(message, ", or a number of ");
    ASSERT_EQ(enough.size(), 2U) << message;
    for (const int number : enough)
      expect_sound(ed::lattice_start(components(number), {.packing_fraction = 1.1 * most}), 1.1 * most);
    // Where none holds so much, how much one that fits holds.
    EXPECT_EQ(numbers_after(refusal(512, 0.7), " with a number of ").size(), 2U) << refusal(512, 0.7);
    EXPECT_EQ(numbers_after(refusal(501, 0.3), "a multiple of 4, best ").size(), 2U) << refusal(501, 0.3);
  }
}

TEST(LatticeStart, RefusesLargeAwkwardNumbersAtOnce) {
  const ed::Species superball = ed::uniform_species(geom::Superellipsoid({1, 1, 1}, 0.5, 0.5));
  const ed::LatticeOptions cubic{.lattice = ed::Lattice::simple_cubic, .packing_fraction = 0.3};
  const std::string message = message_of([&] { (void)lattice(superball, 999983, cubic); });
  EXPECT_THAT(message, HasSubstr("number is 999983: bodies in "));
  EXPECT_EQ(numbers_after(message, ", or a number of ").size(), 2U) << message;
}

TEST(LatticeStart, NamesTheNumbersThatBodiesCanTurnIn) {
  const ed::Species species = ed_test::species(3, Inertia::paper);
  const ed::LatticeOptions options{.packing_fraction = 0.4, .nematic_order = 0.8};
  const std::string message = message_of([&] { (void)lattice(species, 512, options); });
  EXPECT_THAT(message, HasSubstr("cannot rotate beyond an order of 0.86"));
  const std::vector<int> numbers = numbers_after(message, "a number of ");
  ASSERT_EQ(numbers.size(), 2U) << message;
  for (const int number : numbers) EXPECT_EQ(ed::audit(lattice(species, number, options)).overlaps, 0) << number;
}

TEST(LatticeStart, RefusesImpossiblePackingFractions) {
  for (const double phi : {0.0, -0.1, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(message_of([&] { (void)lattice(ed_test::species(3, Inertia::paper), 288, {.packing_fraction = phi}); }),
                HasSubstr("packing_fraction is"));
  }
  const std::string message =
      message_of([] { (void)lattice(ed_test::species(3, Inertia::paper), 288, {.packing_fraction = 5e-324}); });
  EXPECT_THAT(message, HasSubstr("packing_fraction: a box of edge inf"));
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
  const std::vector<double> fractions = short_form() ? std::vector{0.739} : std::vector{0.6, 0.72, 0.739};
  for (const double phi : fractions) {
    const auto refused = [&](double S) {
      return message_of([&] { (void)lattice(species, 288, {.packing_fraction = phi, .nematic_order = S}); });
    };
    const std::string message = refused(0.5);
    EXPECT_THAT(message, HasSubstr("nematic_order is 0.5")) << phi;
    // The value named is accepted.
    const std::string named = message.substr(message.find("at least ") + 9);
    EXPECT_EQ(refused(std::stod(named)), "no std::invalid_argument") << phi << ": " << named;
  }
  // Hardly any room: nothing but an aligned start.
  const std::string message =
      message_of([&] { (void)lattice(species, 288, {.packing_fraction = 0.74048, .nematic_order = 0.5}); });
  EXPECT_THAT(message, HasSubstr("accepted: no nematic_order (all aligned), or a lower packing fraction"));
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

}  // namespace
