// Functions that are called on the way through long work, and end it by an exception.

#include <ed/simulation.h>
#include <ed/start.h>
#include <ed/stored_frames.h>
#include <ed/system.h>

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <vector>

namespace {

struct Stopped : std::runtime_error {
  Stopped() : std::runtime_error("stopped") {}
};

const std::vector<ed::Component> kRods = {{ed::paper_species(geom::Ellipsoid({1, 1, 3})), 4 * 8 * 8 * 8}};

ed::LatticeOptions dilute() {
  ed::LatticeOptions options;
  options.packing_fraction = 0.1;
  return options;
}

/// Function that counts its calls and throws at the call of this number.
std::function<void()> stop_at(int& calls, int last) {
  return [&calls, last] {
    if (++calls == last) throw Stopped();
  };
}

TEST(Poll, IsCalledOnTheWay) {
  const ed::System system = ed::lattice_start(kRods, dilute());
  int calls = 0;
  (void)ed::audit(system, stop_at(calls, -1));
  EXPECT_GE(calls, 8);
  ed::SimulationOptions options;
  options.poll = stop_at(calls = 0, -1);
  ed::Simulation simulation(system, options);
  const int constructed = calls;
  EXPECT_GE(constructed, 4 * 8);  // audit, envelopes, lists, predictions
  simulation.run_collisions(10);
  (void)simulation.shrink_box(0.99 * system.box);
  EXPECT_EQ(calls, constructed);
}

TEST(Poll, EndsWhatItIsCalledBy) {
  const ed::System system = ed::lattice_start(kRods, dilute());
  int calls = 0;
  EXPECT_THROW((void)ed::audit(system, stop_at(calls, 3)), Stopped);
  for (const int last : {1, 10, 20, 30}) {
    ed::SimulationOptions options;
    options.poll = stop_at(calls = 0, last);
    EXPECT_THROW(ed::Simulation(system, options), Stopped);
  }
  ed::LatticeOptions options = dilute();
  options.nematic_order = 0.5;
  options.poll = stop_at(calls = 0, 20);
  EXPECT_THROW((void)ed::lattice_start(kRods, options), Stopped);
}

TEST(Poll, ChangesNothing) {
  int calls = 0;
  ed::LatticeOptions options = dilute();
  options.nematic_order = 0.9;
  const ed::System one = ed::lattice_start(kRods, options);
  options.poll = stop_at(calls, -1);
  const ed::System other = ed::lattice_start(kRods, options);
  for (std::size_t k = 0; k < one.bodies.size(); ++k) EXPECT_EQ(one.bodies[k].rotation, other.bodies[k].rotation);
  EXPECT_GT(calls, 0);
}

TEST(Poll, EndsTheAnalysisOfFrames) {
  std::vector<ed::StoredFrame> frames(20);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames[k].time = static_cast<double>(k);
    frames[k].position = {{0, 0, 0}, {1, 1, static_cast<double>(k)}};
  }
  int calls = 0;
  ed::StoredFramesOptions options{};
  options.box = 10;
  options.length = 1;
  options.axis = {2, 2};
  options.groups = {{2, 2}};
  options.poll = stop_at(calls, 50);
  EXPECT_THROW((void)ed::analyze_frames(frames, options), Stopped);
}

}  // namespace
