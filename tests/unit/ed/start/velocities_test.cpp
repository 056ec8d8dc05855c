// Velocities of starts: momentum zero, and each species at kT = 1 on its own degrees of freedom, whatever its masses.

#include <common/ed/hash.h>
#include <common/ed/start_checks.h>
#include <common/ed/states.h>
#include <common/message_of.h>

#include <ed/ed.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace {

using ed_test::Inertia;
using ed_test::kRounding;
using testing::HasSubstr;

/// Temperatures of the bodies [begin, begin + number) on their own degrees of freedom.
struct GroupTemperatures {
  double translation;
  double rotation;
  double spin;
};

GroupTemperatures temperatures_of(const ed::System& system, int begin, int number) {
  ed::System part;
  part.species = system.species;
  part.bodies.assign(system.bodies.begin() + begin, system.bodies.begin() + begin + number);
  double mass = 0;
  double others = 0;
  for (int i = 0; i < system.size(); ++i) {
    (i >= begin && i < begin + number ? mass : others) += system.species_of(i).mass;
  }
  const ed::KineticState kinetic = ed::kinetic_state(part);
  const double freedoms = 3 * (number - 1) + 3 * others / (mass + others);
  return {2 * kinetic.translational_energy / freedoms, kinetic.rotational_kT,
          kinetic.spin_degrees_of_freedom > 0 ? 2 * kinetic.spin_energy / kinetic.spin_degrees_of_freedom : 1};
}

/// Expects momentum zero, relative to that of a thermal body, and each group at kT = 1.
void expect_thermal(const ed::System& system, const std::vector<int>& groups, double tolerance = kRounding) {
  double heaviest = 0;
  for (int i = 0; i < system.size(); ++i) heaviest = std::max(heaviest, system.species_of(i).mass);
  EXPECT_NEAR(ed::kinetic_state(system).momentum.norm() / std::sqrt(heaviest), 0, kRounding);
  EXPECT_NEAR(ed::kinetic_state(system).translational_kT, 1, kRounding);
  int begin = 0;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const GroupTemperatures kT = temperatures_of(system, begin, groups[k]);
    EXPECT_NEAR(kT.translation, 1, tolerance) << "group " << k;
    EXPECT_NEAR(kT.rotation, 1, kRounding) << "group " << k;
    EXPECT_NEAR(kT.spin, 1, kRounding) << "group " << k;
    begin += groups[k];
  }
}

ed::Component component(double aspect_ratio, double mass, int number) {
  ed::Component result{ed_test::species(aspect_ratio, Inertia::uniform), number};
  result.species.mass *= mass;
  result.species.inertia *= mass;
  return result;
}

struct Composition {
  std::vector<int> numbers;
  std::vector<double> masses;
};

/// Velocities far from thermal, with a momentum.
ed::System moving(const Composition& composition, std::uint64_t seed) {
  ed::System system;
  ed::Random random(seed);
  for (std::size_t k = 0; k < composition.numbers.size(); ++k) {
    system.species.push_back(component(1.5 + 0.5 * static_cast<double>(k % 2), composition.masses[k], 1).species);
    for (int i = 0; i < composition.numbers[k]; ++i) {
      ed::Body& body = system.bodies.emplace_back();
      body.species = static_cast<int>(k);
      body.rotation = random.rotation();
      body.velocity = (Eigen::Vector3d(3, 0, 0) + random.normal3()) / std::sqrt(composition.masses[k]);
      body.angular_velocity = random.normal3();
    }
  }
  system.box = 100;
  return system;
}

TEST(RescaleVelocities, SetsEachGroupWhateverItsMasses) {
  const std::vector<Composition> compositions = {{{50, 60}, {1e-6, 1e6}},
                                                 {{50, 60}, {1e3, 1e-3}},
                                                 {{500, 2}, {1, 1e6}},
                                                 {{1, 100}, {1e6, 1}},
                                                 {{100, 1}, {1, 1e-6}},
                                                 {{1, 1}, {1, 5}},
                                                 {{1, 1, 1}, {1, 1, 1}},
                                                 {{1, 1, 1}, {1, 1e3, 1e6}},
                                                 {{1, 1, 1}, {1e-6, 1, 1e6}},
                                                 {{1, 1, 500}, {1e9, 1, 1}},
                                                 {{1, 1, 1, 1, 500}, {9, 8, 7, 6, 1e-5}},
                                                 {{3, 2, 2, 1}, {1, 1e2, 1e4, 1e6}},
                                                 {{2, 1, 1, 7}, {1, 1, 1, 1}}};
  for (std::size_t c = 0; c < compositions.size(); ++c) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE("composition " + std::to_string(c) + ", seed " + std::to_string(seed));
      ed::System system = moving(compositions[c], seed);
      ed::rescale_velocities(system, compositions[c].numbers);
      // Of a body that outweighs the others 1e9 times the energy, which the tiny momentum of the others leaves to it,
      // is known to the rounding of a sum.
      expect_thermal(system, compositions[c].numbers, 1e-11);
    }
  }
}

TEST(RescaleVelocities, TakesSpeciesAsGroupsAndSingleBodiesAsOne) {
  const Composition composition{{20, 1, 1, 1, 30, 1}, {1, 2, 3, 4, 1e4, 5}};
  ed::System system = moving(composition, 3);
  ed::rescale_velocities(system);
  const double mass = 20 + 2 + 3 + 4 + 30e4 + 5;
  double singles = 0;
  for (const int i : {20, 21, 22, 53}) {
    singles += system.species_of(i).mass * system.bodies[static_cast<std::size_t>(i)].velocity.squaredNorm();
  }
  EXPECT_NEAR(singles / (12 - 3 * 14 / mass), 1, kRounding);
  EXPECT_NEAR(temperatures_of(system, 0, 20).translation, 1, kRounding);
  EXPECT_NEAR(temperatures_of(system, 23, 30).translation, 1, kRounding);
}

TEST(RescaleVelocities, SizesOfOneSpeciesAreScaledTogether) {
  ed::System system = moving({std::vector<int>(40, 1), std::vector<double>(40, 2)}, 4);
  ed::System together = system;
  ed::rescale_velocities(system);
  ed::rescale_velocities(together, {40});
  EXPECT_EQ(ed_test::hash_of(system), ed_test::hash_of(together));
  expect_thermal(system, {40});
}

TEST(RescaleVelocities, KeepsTheMeanVelocitiesOfSpeciesWhereItCan) {
  ed::System system = moving({{50, 50}, {1, 4}}, 5);
  const auto mean_difference = [](const ed::System& s) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 50; ++i) sum += (s.bodies[i].velocity - s.bodies[i + 50].velocity) / 50;
    return sum;
  };
  const Eigen::Vector3d before = mean_difference(system);
  ed::rescale_velocities(system);
  EXPECT_NEAR(before.cross(mean_difference(system)).norm(), 0, kRounding);
}

TEST(RescaleVelocities, RefusesGroupsThatAreNotAllBodies) {
  ed::System system = moving({{5, 5}, {1, 1}}, 6);
  for (const std::vector<int>& groups : {std::vector<int>{5, 4}, {11}, {10, 0}, {12, -2}}) {
    EXPECT_THAT(test_common::message_of([&] { ed::rescale_velocities(system, groups); }),
                HasSubstr("groups: their numbers add up to"));
  }
}

TEST(MixedStarts, EverySpeciesIsAtItsTemperature) {
  for (const double ratio : {1e-6, 1e-3, 1.0, 1e3}) {
    const std::vector<ed::Component> components = {component(2, 1, 40), component(1.5, ratio, 68)};
    for (const double packing_fraction : {0.03, 0.35}) {
      ed::StartOptions options;
      options.packing_fraction = packing_fraction;
      expect_thermal(ed::random_start(components, options), {40, 68});
    }
    ed::LatticeOptions lattice;
    lattice.packing_fraction = 0.3;
    const ed::System start = ed::lattice_start(components, lattice);
    expect_thermal(start, {40, 68});
    expect_thermal(ed::compressed(start, 0.32), {40, 68});
  }
}

TEST(MixedStarts, GroupsOfComponentsAreThoseOfTheOptions) {
  std::vector<ed::Component> components;
  for (int k = 0; k < 60; ++k) components.push_back(component(2, k < 30 ? 1 : 1e4 + k, 1));
  ed::StartOptions options;
  options.packing_fraction = 0.2;
  options.groups = {30, 30};
  const ed::System start = ed::random_start(components, options);
  expect_thermal(start, {30, 30});
  expect_thermal(ed::compressed(start, 0.22, nullptr, nullptr, nullptr, options.groups), {30, 30});
  ed::LatticeOptions lattice;
  lattice.packing_fraction = 0.2;
  lattice.groups = options.groups;
  expect_thermal(ed::lattice_start(components, lattice), {30, 30});
}

}  // namespace
