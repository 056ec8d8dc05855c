#include "run/phases/equilibration.h"

#include "base/signals.h"
#include "run/equilibrated.h"
#include "run/phases/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

/// Packing fraction below which the envelopes keep their first guess. Tuning runs for tens of collisions a body, which
/// take a long time in a dilute gas and gain little there.
constexpr double kTunedPacking = 0.005;

std::vector<ed::RelaxingGroup> relaxing_groups(const Config& config) {
  std::vector<ed::RelaxingGroup> groups;
  for (const SpeciesConfig& species : config.species) groups.push_back({species.number, !is_sphere(species)});
  return groups;
}

double equilibration_length(const Config& config) {
  return config.equilibration_time.value_or(config.equilibration_cap);
}

bool is_over(const Config& config, const Equilibration& result) {
  return result.time >= equilibration_length(config) || (!config.equilibration_time && result.reached());
}

/// Runs until the criterion holds or the config's time is over; what was reached. `run.result` keeps to full time
/// units, at which the criterion is asked, wherever it is stopped: going on from there must not depend on that.
Equilibration run_equilibration(const Config& config, EquilibrationRun& run, Runner& runner) {
  const double length = equilibration_length(config);
  while (!is_over(config, run.result)) {
    // The time asked for, not the clock's, which is rounded.
    const double next = std::min(run.result.time + config.time_unit, length);
    const bool arrived = runner.run_to(next, length);
    if (!arrived) {
      Equilibration now = run.result;
      now.time = run.simulation.time();
      now.stopped = true;
      return now;
    }
    if (next - run.result.time == config.time_unit) run.monitor.measure(run.simulation);
    run.result.time = next;
    run.result.relaxation = run.monitor.state();
  }
  return run.result;
}

/// Describes how far positions and orientations are forgotten; without C2 where no body turns.
std::string decays_text(const ed::Relaxation& relaxation) {
  const std::string f_self = fmt::format("F_self {:.3f}", relaxation.f_self);
  return std::isnan(relaxation.c2) ? f_self : fmt::format("C2 {:.3f} and ", relaxation.c2) + f_self;
}

std::string drift_text(const ed::Relaxation& relaxation) {
  if (relaxation.relaxations == 0) return "no relaxation";
  if (relaxation.relaxations == 1) return "one relaxation";
  return fmt::format("{} relaxations, Z changed by {:.2g} and S by {:.2g} between the last two", relaxation.relaxations,
                     relaxation.Z_change, relaxation.S_change);
}

/// Returns the reason for which an ordered state does not count as equilibrated; empty for others.
std::string ordered_text(const ed::Relaxation& relaxation) {
  const bool ordered = relaxation.order.nematic || relaxation.order.crystal;
  return ordered ? "; " + why_not_equilibrated(relaxation) : "";
}

/// Chosen on a copy of the state: every finder and every kind of neighbour list then goes on from the same start.
void tune_envelope(const Config& config, const Start& start, Equilibration& result, Progress& progress, Saver& saver,
                   Log& log) {
  ed::Simulation trial(start.system, config.simulation_options());
  trial.tune_envelopes([&] {
    if (progress.due()) progress.show("equilibration: choosing the thickness of the neighbour lists");
    if (saver.due()) saver.save([&start] { return checkpoint_of(start); });
    return pending_signal() == 0;
  });
  if (trial.stall()) log.line("while the thickness of the neighbour lists was chosen: " + ed::describe(*trial.stall()));
  result.envelope = trial.envelope();
  result.counters_of_tuning = trial.counters();
  const std::vector<ed::FailedPair>& failed = trial.failures();
  result.failures_of_start.insert(result.failures_of_start.end(), failed.begin(), failed.end());
}

}  // namespace

Checkpoint checkpoint_of(const Start& start) {
  Checkpoint checkpoint;
  checkpoint.phase = "start";
  checkpoint.system = start.system;
  checkpoint.counters_of_start = start.counters;
  checkpoint.failures_of_start = start.failures;
  checkpoint.packing_of_file = start.packing_of_file;
  return checkpoint;
}

std::optional<EquilibrationRun> begin_equilibration(const Config& config, const Start& start, Progress& progress,
                                                    Saver& saver, Log& log) {
  log.line(config.equilibration_time
               ? fmt::format("equilibration: {:g} time units", *config.equilibration_time)
               : fmt::format("equilibration: auto, at most {:g} time units", config.equilibration_cap));
  log.line(fmt::format("finder: {}; neighbours: {}{}", ed::to_string(config.finder),
                       ed::to_string(config.neighbour_search()),
                       config.neighbours_chosen ? " (chosen by \"auto\")" : ""));
  Equilibration result;
  result.counters_of_start = start.counters;
  result.failures_of_start = start.failures;
  result.packing_of_file = start.packing_of_file;
  if (config.packing_fraction >= kTunedPacking && config.neighbour_search() != ed::Neighbours::cells) {
    tune_envelope(config, start, result, progress, saver, log);
    // The best of those that were tried would not be that of an undisturbed run.
    if (pending_signal() != 0) return std::nullopt;
    log.line(fmt::format("equilibration: envelope thickness {:.4g} l", result.envelope));
  }
  ed::Simulation simulation(start.system, config.simulation_options(result.envelope));
  ed::EquilibrationMonitor monitor(simulation, relaxing_groups(config));
  result.kinetic_at_start = simulation.kinetic();
  result.relaxation = monitor.state();
  return EquilibrationRun{std::move(simulation), std::move(monitor), std::move(result)};
}

EquilibrationRun resumed_equilibration(const Config& config, Checkpoint& checkpoint, const std::string& name) {
  ed::Simulation simulation = restored_simulation(config, checkpoint, name);
  ed::EquilibrationMonitor monitor = restored(
      name, [&] { return ed::EquilibrationMonitor::restore(checkpoint.run->monitor, relaxing_groups(config)); });
  return {std::move(simulation), std::move(monitor), checkpoint.run->equilibration};
}

Checkpoint checkpoint_of(const EquilibrationRun& run) {
  Checkpoint checkpoint;
  checkpoint.phase = "equilibration";
  checkpoint.time = run.simulation.time();
  checkpoint.system = run.simulation.system();
  RunState& state = checkpoint.run.emplace();
  state.equilibration = run.result;
  state.monitor = run.monitor.save();
  state.simulation = StoredState([&run](const Sink& sink) { run.simulation.save(sink); });
  return checkpoint;
}

Equilibration equilibrate(const Config& config, EquilibrationRun& run, Progress& progress, Saver& saver, Log& log) {
  progress.begin();
  Runner runner(run.simulation, config.equilibration_time ? "equilibration" : "equilibration (auto, at most)", progress,
                saver, [&run] { return checkpoint_of(run); });
  Equilibration result = run_equilibration(config, run, runner);
  result.system = run.simulation.system();
  result.counters = run.simulation.counters();
  result.failures = run.simulation.failures();
  const ed::Relaxation& relaxation = result.relaxation;
  log.line(fmt::format("equilibration: {} after {:g} time units and {} relaxations, {} at q = {:.4g}{}",
                       result.stopped ? "stopped" : "done", result.time, relaxation.relaxations,
                       decays_text(relaxation), relaxation.q,
                       config.species.size() > 1 ? " (of the slowest species)" : ""));
  if (relaxation.by == ed::EquilibratedBy::stationarity) {
    log.line("equilibration: order and Z are stationary: " + order_text(relaxation));
  }
  if (!config.equilibration_time && !result.stopped && !result.reached()) {
    announce(
        fmt::format("warning: not equilibrated after {:g} time units: {} (wanted below 0.05, twice in a row), {}{}; "
                    "production goes on",
                    result.time, decays_text(relaxation), drift_text(relaxation), ordered_text(relaxation)),
        progress, log);
  }
  return result;
}

}  // namespace hardbody
