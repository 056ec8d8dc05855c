// Events that are prepared ahead: the run is the same, bit for bit, whatever the bodies and the lists.

#include <common/ed/families.h>
#include <common/ed/states.h>
#include <common/full_form.h>
#include <common/geom/shapes.h>

#include <ed/ed.h>

#include <geom/ellipsoid.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace {

using ed_test::Inertia;

struct Named {
  std::string name;
  ed::System system;
};

ed::CustomShape spherocylinder() {
  const geom_test::Spherocylinder shape{1, 0.5};
  return {shape, {"spherocylinder", std::numbers::pi * 0.25 * (2 + 4 * 0.5 / 3), 2, true}};
}

/// Fewer bodies than parts need, as many, and others; every kind. The short form has two of the numbers.
std::vector<Named> systems() {
  std::vector<Named> all;
  const std::vector<int> numbers = short_form() ? std::vector{65, 257} : std::vector{40, 64, 65, 257, 513};
  for (const int number : numbers) {
    all.push_back({std::to_string(number) + " spheroids", ed_test::start({2, 0.3, number, Inertia::paper, 7})});
  }
  all.push_back({"discs that spin", ed_test::start({0.3, 0.35, 300, Inertia::uniform, 8})});
  all.push_back({"spheres", ed_test::start({1, 0.45, 300, Inertia::paper, 9})});
  const ed_test::Family sizes{"spheroids of two sizes",
                              {{ed::uniform_species(geom::Ellipsoid({1, 1, 2})), 60},
                               {ed::uniform_species(geom::Ellipsoid({0.25, 0.25, 0.2})), 240}}};
  const ed_test::Family rods{"a user's rods", {{ed::Species{spherocylinder(), 1, {0.7, 0.7, 0.12}, true}, 70}}};
  for (const ed_test::Family& family : {sizes, rods}) all.push_back({family.name, ed_test::start(family, 0.2)});
  for (const ed_test::Family& family : ed_test::families(130)) {
    all.push_back({family.name, ed_test::start(family, 0.3)});
  }
  all.push_back({"300 superballs", ed_test::start(ed_test::pure("", ed_test::superball(4), 300), 0.3)});
  return all;
}

/// The state after some collisions, half of them after a restart.
std::string end_of(const ed::System& system, const ed::SimulationOptions& options) {
  constexpr std::uint64_t kCollisions = 300;
  ed::Simulation simulation(system, options);
  simulation.run_collisions(kCollisions / 2);
  ed::Simulation resumed = ed::Simulation::restore(simulation.save(), system.species, options);
  resumed.run_collisions(kCollisions / 2);
  return resumed.save();
}

TEST(PreparedAhead, RunsAreTheSame) {
  for (const auto& [name, system] : systems()) {
    for (const ed::Neighbours lists : {ed::Neighbours::dilated, ed::Neighbours::obp, ed::Neighbours::cells}) {
      if (lists != ed::Neighbours::dilated && system.size() < 250) continue;  // they need boxes of several reaches
      SCOPED_TRACE(name + ", lists " + std::to_string(static_cast<int>(lists)));
      ed::SimulationOptions options;
      options.neighbours = lists;
      const std::string as_usual = end_of(system, options);
      options.prepare_from = 1;
      EXPECT_TRUE(end_of(system, options) == as_usual);
    }
  }
}

TEST(PreparedAhead, RunsOfTheBracketingFinderAreTheSame) {
  const ed::System system = ed_test::start({3, 0.4, 128, Inertia::paper, 3});
  ed::SimulationOptions options;
  options.contact.finder = ed::Finder::bracketing;
  const std::string as_usual = end_of(system, options);
  options.prepare_from = 64;
  EXPECT_TRUE(end_of(system, options) == as_usual);
}

}  // namespace
