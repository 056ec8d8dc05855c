#pragma once

/// Simulation as Python sees it: ed::Simulation with what has to be watched while it runs.

#include "simulation/systems.h"

#include <ed/observables.h>
#include <ed/simulation.h>

#include <nanobind/nanobind.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody::python {

namespace nb = nanobind;

/// Observables of a simulation, with the options that they were made with.
struct Measurement {
  ed::ObservablesOptions options;
  ed::Observables observables;
};

/// End of a run, and the functions that are called on the way.
struct RunPlan {
  double end = std::numeric_limits<double>::infinity();
  std::uint64_t collisions = ~std::uint64_t{0};  ///< number of further collisions
  double every = 0;                              ///< time between two calls of `callback`
  nb::handle callback{};                         ///< null or None: none
  nb::handle progress{};                         ///< null or None: none
};

/// Simulation with its options and observables. All members are called with the GIL; it is released while the event
/// loop runs. Meanwhile every access from other threads, from callbacks of shapes too, is refused by a RuntimeError.
class PythonSimulation {
 public:
  PythonSimulation(const BodySystem& bodies, const ed::SimulationOptions& options);

  /// Returns the simulation between two events. Throws RuntimeError within one, and after an exception there.
  const ed::Simulation& whole() const;
  /// Returns why whole() throws, in a few words; empty if it does not.
  const char* trouble() const { return is_busy_ ? "running" : is_broken_ ? "left within an event" : ""; }
  /// Returns the simulation, to be changed. Throws RuntimeError while it runs, also between events.
  ed::Simulation& idle();

  const ed::SimulationOptions& options() const { return options_; }
  const std::vector<int>& groups() const { return groups_; }
  BodySystem bodies() const { return {whole().system(), groups_}; }
  const std::vector<std::shared_ptr<Measurement>>& measurements() const { return measurements_; }

  /// Runs until one of the plan's ends is reached. `self`: the Python object, for the callback.
  void run(nb::handle self, const RunPlan& plan);

  double shrink_box(nb::handle target_box, double least_gain);
  void tune_envelopes();

  /// Starts measuring, at time 0. Throws ValueError at another time.
  std::shared_ptr<Measurement> measure(ed::ObservablesOptions options);

  /// Hands on the state's bytes; those of user's shapes are names and radii alone.
  void save(const std::function<void(std::string_view)>& sink) const;
  /// Returns a simulation from such bytes. `shapes`: the user's own, in the order of their species. Throws
  /// std::invalid_argument for bytes that are no state.
  static PythonSimulation restore(std::string_view bytes, const std::vector<ed::CustomShape>& shapes);

 private:
  PythonSimulation(ed::Simulation simulation, const ed::SimulationOptions& options, std::vector<int> groups);
  static PythonSimulation restore_checked(std::string_view bytes, const std::vector<ed::CustomShape>& shapes);

  bool advance(double time, std::uint64_t last_collision, const std::function<void()>& report);
  bool run_slice(double time, std::uint64_t most_collisions);
  void run_to_end(nb::handle self, const RunPlan& plan);
  template <class Work>
  void change(const Work& work);
  double next_measurement() const;
  void take_measurements(double time);
  void check_trouble();
  void refuse_rest(const char* what);
  void refuse_with_observables(const char* what);

  ed::Simulation simulation_;
  ed::SimulationOptions options_;
  std::vector<int> groups_;
  std::vector<std::shared_ptr<Measurement>> measurements_;
  ed::Counters seen_;  ///< counters when troubles were last looked for
  double slice_;       ///< collisions of the next slice
  bool is_running_ = false;
  bool is_busy_ = false;    ///< the event loop runs, without the GIL
  bool is_broken_ = false;  ///< true once an exception has left an event unfinished
};

}  // namespace hardbody::python
