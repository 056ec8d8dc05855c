// Nothing allocates in the event loop in steady state: every call of operator new is counted.

#include <common/counted_allocations.h>
#include <common/ed/families.h>
#include <common/ed/states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <string>

namespace {

using ed_test::Inertia;
using ed_test::State;

struct Length {
  std::uint64_t warm_up = 100000;  ///< lists, cells and buffers grow until each has met its largest size
  std::uint64_t collisions = 10000;
};

void expect_no_allocation(const std::string& what, const ed::System& start, const ed::SimulationOptions& options,
                          const Length& length) {
  ed::Simulation simulation(start, options);
  simulation.run_collisions(length.warm_up);
  const std::uint64_t before = allocations;
  const std::uint64_t rebuilds = simulation.counters().neighbour_rebuilds;
  simulation.run_collisions(length.collisions);
  const std::uint64_t count = allocations - before;
  std::printf("%s: %llu allocations in %llu collisions\n", what.c_str(), static_cast<unsigned long long>(count),
              static_cast<unsigned long long>(length.collisions));
  EXPECT_EQ(count, 0U);
  EXPECT_GT(simulation.counters().neighbour_rebuilds, rebuilds + length.collisions / 100);
}

void expect_no_allocation(const State& state, const ed::SimulationOptions& options = {}, const Length& length = {}) {
  expect_no_allocation(ed_test::describe(state), ed_test::start(state), options, length);
}

TEST(Allocations, NoneInSteadyStateOfGeneralBodies) {
  for (const ed_test::Family& family : ed_test::families(216)) {
    expect_no_allocation(family.name, ed_test::start(family, 0.40), {}, {5000, 3000});
  }
}

TEST(Allocations, NoneInSteadyStateOfRods) {
  expect_no_allocation({3, 0.40, 256, Inertia::paper, 51});
}

TEST(Allocations, NoneInSteadyStateWithOrientedBoxes) {
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::obp;
  expect_no_allocation({3, 0.40, 256, Inertia::paper, 53}, options);
}

TEST(Allocations, NoneInSteadyStateWithCells) {
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::cells;
  expect_no_allocation({2, 0.20, 256, Inertia::paper, 54}, options);
}

TEST(Allocations, NoneInSteadyStateOfThePapersFinder) {
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::obp;
  options.contact.finder = ed::Finder::bracketing;
  options.contact.distance = ed::DistanceMethod::newton5;
  expect_no_allocation({3, 0.40, 256, Inertia::paper, 55}, options, {8000, 2000});
}

TEST(Allocations, NoneByDistancesThatNewtonsMethodDeclines) {
  // Seeds in the middle of the bodies: a failure with each search, the first ones recorded.
  ed::SimulationOptions options;
  options.contact.finder = ed::Finder::bracketing;
  options.contact.distance = ed::DistanceMethod::newton5;
  options.contact.seed = [](const geom::Shape&, const geom::Pose& X_WA, const geom::Shape&, const geom::Pose& X_WB) {
    return geom::WitnessPair{X_WA.position(), X_WB.position(), geom::SeedStatus::usable};
  };
  expect_no_allocation({3, 0.40, 256, Inertia::paper, 56}, options, {4000, 1000});
}

TEST(Allocations, NoneInSteadyStateOfSpinningDiscs) {
  expect_no_allocation({0.5, 0.40, 256, Inertia::uniform, 52});
}

}  // namespace
