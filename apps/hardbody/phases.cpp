#include "phases.h"

#include "signals.h"

#include <ed/observables.h>
#include <ed/simulation.h>
#include <ed/start.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace hardbody {
namespace {

/// Seconds between two looks at the clock and at signals.
constexpr double kLook = 0.1;

/// Collisions in the first slice of a phase: little work for the slowest finder, and it grows by kGrowth at most.
constexpr double kFirstSlice = 10;
constexpr double kGrowth = 4;
constexpr double kLongestSlice = 1e6;

/// "auto": equilibration looks at its criterion after each unit of time, and gives up after this many.
constexpr double kEquilibrationCap = 500;

/// "auto": production in units of the equilibration time, and its limits.
constexpr double kProductionFactor = 30;
constexpr double kLeastProduction = 30;
constexpr double kMostProduction = 5000;

/// Below this packing fraction the envelopes keep their first guess. Tuning runs for tens of collisions a
/// body, which take a long time in a dilute gas, and there is next to nothing to gain.
constexpr double kTunedPacking = 0.005;

/// Runs to `time` in slices, shows where the phase is; false if a signal came first.
class Runner {
 public:
  Runner(ed::Simulation& simulation, std::string phase, Progress& progress, Saver& saver)
      : simulation_(simulation),
        progress_(progress),
        saver_(saver),
        phase_(std::move(phase)),
        begin_(simulation.time()),
        collisions_(simulation.counters().collisions),
        energy_(simulation.kinetic().energy()) {
    progress.begin();
  }

  bool run_to(double time, double planned_end) {
    while (pending_signal() == 0) {
      const bool arrived = run_slice(time);
      if (progress_.due()) progress_.show(text(planned_end));
      if (saver_.due()) saver_.save(simulation_.system(), simulation_.time() - begin_);
      if (arrived) return true;
    }
    return false;
  }

 private:
  /// Where a slice ends changes no bit of the run, so that its length may follow the clock.
  bool run_slice(double time) {
    const double begin = progress_.seconds();
    const bool arrived = simulation_.run_until(time, static_cast<std::uint64_t>(slice_));
    const double seconds = progress_.seconds() - begin;
    // A slice that was cut short by `time` says nothing of longer ones.
    if (!arrived || seconds > kLook) {
      slice_ = std::clamp(slice_ * std::min(kGrowth, kLook / std::max(seconds, 1e-9)), 1.0, kLongestSlice);
    }
    return arrived;
  }

  std::string text(double planned_end) const {
    const double done = simulation_.time() - begin_;
    const double total = planned_end - begin_;
    const double seconds = progress_.seconds();
    const auto collisions = static_cast<double>(simulation_.counters().collisions - collisions_);
    return fmt::format("{} {:.2f} of {:g}  {:.0f} collisions/s  {}  energy drift {:.1e}", phase_, done, total,
                       collisions / std::max(seconds, 1e-9), eta(seconds, done, total),
                       std::abs(simulation_.kinetic().energy() / energy_ - 1));
  }

  ed::Simulation& simulation_;
  Progress& progress_;
  Saver& saver_;
  std::string phase_;
  double begin_;
  double slice_ = kFirstSlice;
  std::uint64_t collisions_;
  double energy_;
};

double production_time(const Config& config, const Equilibration& equilibration) {
  if (config.production_time) return *config.production_time;
  return std::clamp(kProductionFactor * equilibration.time, kLeastProduction, kMostProduction);
}

/// Runs until the criterion holds or the config's time is over.
void run_equilibration(const Config& config, ed::Simulation& simulation, Runner& runner, Equilibration& result) {
  const double length = config.equilibration_time.value_or(kEquilibrationCap);
  const double begin = simulation.time();
  ed::Snapshot origin;
  ed::Snapshot now;
  simulation.sample(origin);
  while (result.time < length && !result.stopped) {
    // The time asked for, not the clock's: begin + time is rounded.
    const double next = std::min(result.time + 1, length);
    result.stopped = !runner.run_to(begin + next, begin + length);
    result.time = result.stopped ? simulation.time() - begin : next;
    simulation.sample(now);
    result.c2 = ed::c2_between(origin, now);
    result.msd = ed::msd_between(origin, now);
    if (!config.equilibration_time && result.reached(config)) break;
  }
}

/// Chosen on a copy of the state: every finder and every kind of neighbour list then goes on from the same start.
double tuned_envelope(const Config& config, const ed::System& start, Progress& progress) {
  ed::Simulation trial(start, config.simulation_options());
  trial.tune_envelopes([&] {
    if (progress.due()) progress.show("equilibration: choosing the thickness of the neighbour lists");
    return pending_signal() == 0;
  });
  return trial.envelope();
}

}  // namespace

std::optional<ed::System> make_start(const Config& config, Progress& progress, Log& log) {
  log.line(fmt::format("start: {} bodies placed at random, compressed to packing fraction {:g}", config.number,
                       config.packing_fraction));
  progress.begin();
  ed::StartOptions options;
  options.number = config.number;
  options.packing_fraction = config.packing_fraction;
  options.seed = static_cast<std::uint64_t>(config.seed);
  options.progress = [&](double reached) {
    if (progress.due()) {
      progress.show(fmt::format("compression: packing fraction {:.4f} of {:g}", reached, config.packing_fraction));
    }
    return pending_signal() == 0;
  };
  try {
    ed::System start = ed::random_start(config.species, options);
    if (pending_signal() != 0) return std::nullopt;
    log.line("start: done");
    return start;
  } catch (const std::runtime_error&) {
    if (pending_signal() != 0) return std::nullopt;
    throw;
  }
}

Equilibration equilibrate(const Config& config, const ed::System& start, Progress& progress, Saver& saver, Log& log) {
  log.line(config.equilibration_time ? fmt::format("equilibration: {:g} time units", *config.equilibration_time)
                                     : fmt::format("equilibration: auto, at most {:g} time units", kEquilibrationCap));
  saver.begin("equilibration");
  log.line(fmt::format("finder: {}; neighbours: {}{}", config.finder, config.neighbours,
                       config.neighbours_chosen ? " (chosen by \"auto\")" : ""));
  Equilibration result;
  if (config.packing_fraction >= kTunedPacking && config.neighbours != "cells") {
    result.envelope = tuned_envelope(config, start, progress);
    log.line(fmt::format("equilibration: envelope thickness {:.4g} l", result.envelope));
  }
  ed::Simulation simulation(start, config.simulation_options(result.envelope));
  result.kinetic_at_start = simulation.kinetic();
  Runner runner(simulation, config.equilibration_time ? "equilibration" : "equilibration (auto, at most)", progress,
                saver);
  run_equilibration(config, simulation, runner, result);
  result.system = simulation.system();
  result.counters = simulation.counters();
  result.failures = simulation.failures();
  log.line(fmt::format("equilibration: {} after {:g} time units, C2 {:.4f}, MSD {:.4g} l^2",
                       result.stopped ? "stopped" : "done", result.time, result.c2, result.msd));
  if (!config.equilibration_time && !result.stopped && !result.reached(config)) {
    const std::string warning = fmt::format(
        "warning: not equilibrated after {:g} time units: C2 is {:.3f} (wanted below 0.05), MSD {:.3g} l^2 "
        "(wanted above 1); production goes on",
        result.time, result.c2, result.msd);
    log.line(warning);
    progress.say(warning);
  }
  return result;
}

Production produce(const Config& config, const Equilibration& equilibration, Progress& progress, Saver& saver,
                   Log& log) {
  saver.begin("production");
  Production result;
  result.planned = production_time(config, equilibration);
  log.line(fmt::format("production: {:g} time units", result.planned));
  const double clock = log.seconds();
  // A new simulation: its time starts at 0 and its counters count production only.
  ed::Simulation simulation(equilibration.system, config.simulation_options(equilibration.envelope));
  simulation.record_collisions(static_cast<std::size_t>(config.events));
  ed::ObservablesOptions options{};
  options.number = config.number;
  options.duration = result.planned;
  ed::Observables observables(options);
  result.kinetic_at_start = simulation.kinetic();
  Runner runner(simulation, "production", progress, saver);
  for (bool end = false; !end && !result.stopped;) {
    const double next = observables.next_time();
    const double target = std::min(next, result.planned);
    result.stopped = !runner.run_to(target, result.planned);
    if (!result.stopped && next <= result.planned) observables.measure(simulation);
    end = target == result.planned && observables.next_time() > result.planned;
  }
  result.results = observables.results(simulation);
  result.wall_seconds = log.seconds() - clock;
  result.time = result.stopped ? simulation.time() : result.planned;
  result.system = simulation.system();
  result.envelope = simulation.envelope();
  result.counters = simulation.counters();
  result.collisions = simulation.collisions();
  result.failures = simulation.failures();
  log.line(fmt::format("production: {} at {:g} time units, {} collisions in {:.3f} s",
                       result.stopped ? "stopped" : "done", result.time, result.counters.collisions,
                       result.wall_seconds));
  return result;
}

}  // namespace hardbody
