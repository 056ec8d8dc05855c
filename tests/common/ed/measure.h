#pragma once

/// Run in the same phases as the program's: start, equilibration, production with observables.

#include <common/ed/states.h>

#include <ed/ed.h>

#include <cstdint>

namespace ed_test {

struct Protocol {
  double equilibration;    ///< time of the equilibration, in time units
  double duration;         ///< duration of the production
  double longest_lag = 0;  ///< longest lag; 0: the default of ObservablesOptions
};

struct Measured {
  ed::Results results;
  ed::Audit audit;
  std::uint64_t collisions = 0;
  std::uint64_t overlaps = 0;
};

/// Runs the production from an equilibrated state.
inline Measured measure(ed::System system, const Protocol& protocol) {
  double envelope = 0;
  {
    ed::Simulation simulation(system);
    simulation.tune_envelopes();
    system = simulation.system();
    envelope = simulation.envelope();
  }
  ed::Simulation simulation(system, {envelope});
  ed::Observables observables({system.size(), protocol.duration, protocol.longest_lag});
  while (observables.next_time() <= protocol.duration) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
  }
  simulation.run_until(protocol.duration);
  return {observables.results(simulation), ed::audit(simulation.system()), simulation.counters().collisions,
          simulation.counters().overlaps};
}

inline Measured measure(const State& state, const Protocol& protocol) {
  return measure(equilibrated(state, protocol.equilibration), protocol);
}

}  // namespace ed_test
