// The work of the event loop, in counters: the same on every machine, so that a loss of speed shows without a clock.

#include <common/ed/states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <cstdio>

namespace {

TEST(Counters, EvaluationsAndRefinementsPerCollisionStayWithinTheirBounds) {
  constexpr std::uint64_t kCollisions = 100000;
  ed::Simulation simulation(ed_test::equilibrated({3, 0.40, 512}, 1));
  simulation.tune_envelopes();
  const ed::Counters before = simulation.counters();
  simulation.run_collisions(kCollisions);
  const ed::Counters after = simulation.counters();

  const auto per_collision = [](std::uint64_t from, std::uint64_t to) {
    return static_cast<double>(to - from) / static_cast<double>(kCollisions);
  };
  const double evaluations = per_collision(before.evaluations, after.evaluations);
  const double refinements = per_collision(before.refinements, after.refinements);
  const double predictions = per_collision(before.predictions, after.predictions);
  const double rebuilds = per_collision(before.neighbour_rebuilds, after.neighbour_rebuilds);
  std::printf("a collision: %.2f evaluations, %.2f refinements, %.2f predictions, %.2f rebuilds; envelope %.3f\n",
              evaluations, refinements, predictions, rebuilds, simulation.envelope());
  ASSERT_EQ(after.collisions - before.collisions, kCollisions);
  EXPECT_LE(evaluations, 45);
  EXPECT_LE(refinements, 2);
  // A body has 20 to 25 neighbours here and each collision predicts those of two bodies: far fewer evaluations would
  // mean that pairs are not looked at.
  EXPECT_GE(evaluations, 20);
  EXPECT_GE(evaluations, predictions);
  EXPECT_GT(rebuilds, 0);
}

/// Measures other bodies as bench_bodies does.
TEST(Counters, OfOtherBodiesPerCollisionStayWithinTheirBounds) {
  struct Bound {
    const char* name;
    ed::BodyShape shape;
    double evaluations, kernel_calls;
  };
  for (const Bound& bound :
       {Bound{"superballs, p = 4", geom::Superellipsoid({1, 1, 1}, 0.5, 0.5), 20.5, 35},
        Bound{"superellipsoids 1 : 1 : 2, e = 0.5", geom::Superellipsoid({1, 1, 2}, 0.5, 0.5), 33.5, 52},
        Bound{"ellipsoids 1 : 0.8 : 0.5", geom::Ellipsoid({1, 0.8, 0.5}), 30, 38.5}}) {
    constexpr std::uint64_t kCollisions = 8000;
    ed::StartOptions options;
    options.number = 512;
    options.packing_fraction = 0.40;
    ed::Simulation simulation(ed::random_start(ed::uniform_species(bound.shape), options));
    simulation.run_collisions(5000);
    simulation.tune_envelopes();
    const ed::Counters before = simulation.counters();
    simulation.run_collisions(kCollisions);
    const ed::Counters after = simulation.counters();
    const double evaluations = static_cast<double>(after.evaluations - before.evaluations) / kCollisions;
    const double kernel_calls = static_cast<double>(after.kernel_calls - before.kernel_calls) / kCollisions;
    std::printf("%s, a collision: %.2f evaluations, %.2f kernel calls\n", bound.name, evaluations, kernel_calls);
    EXPECT_LE(evaluations, bound.evaluations) << bound.name;
    EXPECT_LE(kernel_calls, bound.kernel_calls) << bound.name;
  }
}

TEST(Counters, OfThePapersFinderAndListsAreWhatTheDocumentationSays) {
  const ed::System system = ed_test::equilibrated({3, 0.40, 512}, 1);
  // A simulation looks at each pair of neighbours once before it starts.
  const auto neighbours_a_body = [&](ed::Neighbours kind) {
    ed::SimulationOptions options;
    options.neighbours = kind;
    ed::Simulation trial(system, options);
    trial.tune_envelopes();
    options.envelope = trial.envelope();
    const ed::Simulation simulation(system, options);
    return 2 * static_cast<double>(simulation.counters().predictions) / system.size();
  };
  const double cells = neighbours_a_body(ed::Neighbours::cells);
  const double boxes = neighbours_a_body(ed::Neighbours::obp);

  constexpr std::uint64_t kCollisions = 2000;
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::obp;
  options.contact.finder = ed::Finder::bracketing;
  ed::Simulation simulation(system, options);
  simulation.tune_envelopes();
  const ed::Counters before = simulation.counters();
  simulation.run_collisions(kCollisions);
  const auto distances =
      static_cast<double>(simulation.counters().evaluations - before.evaluations) / static_cast<double>(kCollisions);
  std::printf("bracketing: %.1f distances a collision; neighbours of a body: %.1f in cells, %.1f in boxes\n", distances,
              cells, boxes);
  EXPECT_NEAR(distances, 240, 24);
  EXPECT_NEAR(cells, 215, 11);
  EXPECT_NEAR(boxes, 16, 2);
}

}  // namespace
