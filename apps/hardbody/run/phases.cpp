#include "run/phases.h"

#include "base/errors.h"
#include "base/signals.h"

#include <ed/archive_system.h>
#include <ed/observables.h>
#include <ed/shape.h>
#include <ed/simulation.h>
#include <ed/system.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

/// Seconds between two looks at the clock and at signals.
constexpr double kLook = 0.1;

/// Collisions in the first slice of a phase: little work for the slowest finder, and it grows by kGrowth at most.
constexpr double kFirstSlice = 10;
constexpr double kGrowth = 4;
constexpr double kLongestSlice = 1e6;
/// Events in a slice for each of its collisions, at the most: some times what sound runs need. A run that stalls has
/// any number of them without a collision.
constexpr double kEventsOfACollision = 100;

/// "auto": production in units of the equilibration time, and its limits. Times are in units of Config::time_unit.
constexpr double kProductionFactor = 30;
constexpr double kLongestLag = 40;  ///< or the equilibration, if that took longer
/// At least, in collisions of a body: diffusion coefficients are fitted from 0.4 of it on, and a velocity is forgotten
/// in about 1.5 of them, so that what is left of it there is exp(-7).
constexpr double kLagCollisions = 25;
/// Longest lags that production lasts, at least. With a target error it is asked for then, and again each time that the
/// run has grown by a factor.
constexpr double kLags = 16;
constexpr double kNextLook = 1.25;

/// Below this packing fraction the envelopes keep their first guess. Tuning runs for tens of collisions a
/// body, which take a long time in a dilute gas, and there is next to nothing to gain.
constexpr double kTunedPacking = 0.005;

/// Runs to `time` in slices, shows where the phase is and saves it; false if a signal came first, or it has stalled.
class Runner {
 public:
  Runner(ed::Simulation& simulation, std::string phase, Progress& progress, Saver& saver,
         std::function<Checkpoint()> checkpoint, std::function<void()> keep_up = {})
      : simulation_(simulation),
        progress_(progress),
        saver_(saver),
        checkpoint_(std::move(checkpoint)),
        keep_up_(std::move(keep_up)),
        phase_(std::move(phase)),
        begin_(simulation.time()),
        collisions_(simulation.counters().collisions),
        energy_(simulation.kinetic().energy()) {}

  bool run_to(double time, double planned_end) {
    while (pending_signal() == 0 && !simulation_.stall()) {
      const bool arrived = run_slice(time);
      if (keep_up_) keep_up_();
      if (progress_.due()) progress_.show(text(planned_end));
      if (saver_.due()) saver_.save(checkpoint_);
      if (arrived) return true;
    }
    return false;
  }

 private:
  /// Where a slice ends changes no bit of the run, so that its length may follow the clock.
  bool run_slice(double time) {
    const double begin = progress_.seconds();
    const bool arrived = simulation_.run_until(time, static_cast<std::uint64_t>(slice_),
                                               static_cast<std::uint64_t>(kEventsOfACollision * slice_));
    const double seconds = progress_.seconds() - begin;
    // A slice that was cut short by `time` says nothing of longer ones.
    if (!arrived || seconds > kLook) {
      slice_ = std::clamp(slice_ * std::min(kGrowth, kLook / std::max(seconds, 1e-9)), 1.0, kLongestSlice);
    }
    return arrived;
  }

  std::string text(double planned_end) const {
    const double done = simulation_.time();
    const double seconds = progress_.seconds();
    const auto collisions = static_cast<double>(simulation_.counters().collisions - collisions_);
    return fmt::format("{} {:.4g} of {:g}  {:.0f} collisions/s  {}  energy drift {:.1e}", phase_, done, planned_end,
                       collisions / std::max(seconds, 1e-9), eta(seconds, done - begin_, planned_end - begin_),
                       std::abs(simulation_.kinetic().energy() / energy_ - 1));
  }

  ed::Simulation& simulation_;
  Progress& progress_;
  Saver& saver_;
  std::function<Checkpoint()> checkpoint_;
  std::function<void()> keep_up_;  ///< after each slice
  std::string phase_;
  double begin_;  ///< of what this process does
  double slice_ = kFirstSlice;
  std::uint64_t collisions_;
  double energy_;
};

/// kLagCollisions mean collision intervals; 0 if nothing is known of them.
double dilute_lag(const Config& config, const Equilibration& equilibration) {
  const auto collisions = static_cast<double>(equilibration.counters.collisions);
  return collisions > 0 ? kLagCollisions * equilibration.time * config.number / (2 * collisions) : 0;
}

/// Of a production without a target error.
double usual_length(const Config& config, const Equilibration& equilibration) {
  const double unit = config.time_unit;
  return std::clamp(kProductionFactor * equilibration.time, kLeastProduction * unit, kMostProduction * unit);
}

/// How long production is to be, and what is measured in it.
Production planned_production(const Config& config, const Equilibration& equilibration) {
  Production plan;
  const double length = usual_length(config, equilibration);
  const double longest_lag = kLongestLag * config.time_unit;
  const double most = kMostProduction * config.time_unit;
  if (config.production_time) {
    plan.planned = *config.production_time;
    plan.longest_lag = std::min(plan.planned / kLags, longest_lag);
  } else {
    // A state that was slow to equilibrate decays as slowly.
    plan.longest_lag = std::min(length / kLags, std::max(longest_lag, equilibration.time));
    plan.longest_lag = std::max(plan.longest_lag, std::min(dilute_lag(config, equilibration), most / kLags));
    plan.planned = config.target_error ? most : std::max(length, kLags * plan.longest_lag);
  }
  plan.next_look = kLags * plan.longest_lag;
  const double q = equilibration.relaxation.q;
  plan.wave_numbers = config.wave_numbers;
  if (plan.wave_numbers.empty()) plan.wave_numbers = ed::wave_numbers_about(q);
  return plan;
}

std::vector<ed::RelaxingGroup> relaxing_groups(const Config& config) {
  std::vector<ed::RelaxingGroup> groups;
  for (const SpeciesConfig& species : config.species) groups.push_back({species.number, !is_sphere(species)});
  return groups;
}

bool precise_enough(const ed::Estimate& D, double target) {
  return D.error <= target * std::abs(D.value);
}

/// The diffusion coefficients that are to have the error asked for. Spheres turn freely and have no D_rot; nor has the
/// mixture of spheres and others, whose others then each have one.
std::vector<ed::Estimate> wanted_coefficients(const Config& config, const ed::Results& results) {
  std::vector<ed::Estimate> wanted = {results.D_trans};
  if (std::none_of(config.species.begin(), config.species.end(), is_sphere)) {
    wanted.push_back(results.D_rot);
    return wanted;
  }
  for (std::size_t k = 0; k < config.species.size() && k < results.groups.size(); ++k) {
    if (!is_sphere(config.species[k])) wanted.push_back(results.groups[k].D_rot);
  }
  return wanted;
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

/// How far positions and orientations are forgotten. Where no body turns there is no C2.
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

/// What `restore` gives; as InputError if it does not fit.
template <class F>
auto restored(const std::string& name, const F& restore) {
  try {
    return restore();
  } catch (const std::invalid_argument& error) {
    throw InputError(
        fmt::format("{}: holds an impossible state ({}); accepted: an undamaged checkpoint", name, error.what()));
  }
}

/// The bytes are let go.
ed::Simulation restored_simulation(const Config& config, Checkpoint& checkpoint, const std::string& name) {
  return restored(name, [&] {
    ed::Simulation simulation = ed::Simulation::restore(checkpoint.run->simulation.bytes(), checkpoint.system.species,
                                                        config.simulation_options());
    checkpoint.run->simulation = {};
    if (ed::archive::bytes_of(simulation.system()) == ed::archive::bytes_of(checkpoint.system)) return simulation;
    throw std::invalid_argument("state: two that should be the same differ");
  });
}

ed::ObservablesOptions observables_options(const Config& config, const Production& production) {
  ed::ObservablesOptions options{};
  options.number = config.number;
  options.duration = production.planned > 0 ? production.planned : config.time_unit;  // of none nothing is measured
  options.time_unit = config.time_unit;
  options.longest_lag = production.longest_lag;
  options.wave_numbers = production.wave_numbers;
  options.groups = config.groups();
  return options;
}

}  // namespace

Checkpoint checkpoint_of(const Start& start) {
  Checkpoint checkpoint;
  checkpoint.phase = "start";
  checkpoint.system = start.system;
  checkpoint.counters_of_start = start.counters;
  checkpoint.failures_of_start = start.failures;
  return checkpoint;
}

// ---- Equilibration

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
  if (!config.equilibration_time && !result.stopped && !result.reached()) {
    const std::string warning = fmt::format(
        "warning: not equilibrated after {:g} time units: {} (wanted below 0.05, twice in a row), {}; production goes "
        "on",
        result.time, decays_text(relaxation), drift_text(relaxation));
    log.line(warning);
    progress.say(warning);
  }
  return result;
}

// ---- Production

namespace {

/// Runs to `time`, taking the frames that are due until then; false if the run was stopped before.
bool run_to(double time, ProductionRun& run, Runner& runner, Log& log) {
  const double planned = run.result.planned;
  while (run.trajectory.next_time() <= time) {
    if (!runner.run_to(run.trajectory.next_time(), planned)) return false;
    run.trajectory.take(run.simulation, log);
  }
  return runner.run_to(time, planned);
}

/// With a target error, once in a while, at times that do not depend on a clock: whether nothing is to be gained by
/// going on. A coefficient that has no value after a production of the usual length will not get one: motion is
/// ballistic up to the longest lag, as the rotation of what is nearly a sphere, or arrested.
bool look_at_errors(const Config& config, ProductionRun& run, Log& log) {
  run.result.next_look *= kNextLook;
  const std::vector<ed::Estimate> wanted = wanted_coefficients(config, run.observables.results(run.simulation));
  const auto precise = [&](const ed::Estimate& D) { return precise_enough(D, *config.target_error); };
  run.result.precise = std::all_of(wanted.begin(), wanted.end(), precise);
  if (run.result.precise) return true;
  const auto hopeless = [&](const ed::Estimate& D) { return !std::isfinite(D.value); };
  if (run.simulation.time() < usual_length(config, run.before)) return false;
  if (!std::all_of(wanted.begin(), wanted.end(), [&](const auto& D) { return precise(D) || hopeless(D); }))
    return false;
  log.line(
      fmt::format("production: no {} at lags up to {:g}, motion is not diffusive there: target_error is not reached",
                  hopeless(wanted[0]) ? "D_trans" : "D_rot", run.result.longest_lag));
  return true;
}

}  // namespace

ProductionRun begin_production(const Config& config, Equilibration equilibration, const RunDirectory& directory,
                               Log& log) {
  Production production = planned_production(config, equilibration);
  log.line(
      config.target_error
          ? fmt::format("production: until the relative errors of D_trans and D_rot are {:g}, at most {:g} time units",
                        *config.target_error, production.planned)
          : fmt::format("production: {:g} time units", production.planned));
  // A new simulation: its time starts at 0 and its counters count production only.
  ed::Simulation simulation(equilibration.system, config.simulation_options(equilibration.envelope));
  std::optional<ed::System> begin;
  if (!config.trajectory.empty()) begin = std::move(equilibration.system);
  equilibration.system = {};
  ProductionRun run{std::move(simulation),
                    ed::Observables(observables_options(config, production)),
                    EventsFile(directory, config.events),
                    Trajectory(directory, config, production.planned),
                    std::move(equilibration),
                    std::move(production),
                    std::move(begin)};
  run.result.kinetic_at_start = run.simulation.kinetic();
  return run;
}

ProductionRun resumed_production(const Config& config, Checkpoint& checkpoint, const RunDirectory& directory,
                                 const std::string& name) {
  RunState& state = *checkpoint.run;
  ProductionRun run{restored_simulation(config, checkpoint, name),
                    restored(name,
                             [&] {
                               return ed::Observables::restore(state.observables.bytes(),
                                                               observables_options(config, state.production));
                             }),
                    EventsFile(directory, config.events),
                    Trajectory(directory, config, state.production.planned),
                    state.equilibration,
                    state.production};
  state.observables = {};
  run.result.wall_seconds = checkpoint.upkeep.production_seconds;
  run.events.check(state.events);
  run.trajectory.check(state.trajectory);
  return run;
}

bool lags_are_longest(const Config& config, const Production& production) {
  return production.longest_lag >= kLongestLag * config.time_unit * (1 - 1e-9);
}

Checkpoint checkpoint_of(ProductionRun& run) {
  run.events.take(run.simulation);
  run.trajectory.flush();
  Checkpoint checkpoint;
  checkpoint.phase = "production";
  checkpoint.time = run.simulation.time();
  checkpoint.system = run.simulation.system();
  checkpoint.upkeep.production_seconds = run.result.wall_seconds;
  RunState& state = checkpoint.run.emplace();
  state.equilibration = run.before;
  state.production = run.result;
  state.events = run.events.mark();
  state.trajectory = run.trajectory.mark();
  state.simulation = StoredState([&run](const Sink& sink) { run.simulation.save(sink); });
  state.observables = StoredState([&run](const Sink& sink) { run.observables.save(sink); });
  return checkpoint;
}

void produce(const Config& config, ProductionRun& run, const FilesMark& files, Progress& progress, Saver& saver,
             Log& log) {
  Production& result = run.result;
  const double earlier = result.wall_seconds;
  const double clock = log.seconds();
  const auto seconds = [&] { return earlier + log.seconds() - clock; };
  run.events.open(files.events, run.simulation);
  run.trajectory.open(files.trajectory);
  // Before a checkpoint can be made: none is without it.
  if (run.begin) run.trajectory.take_first(*run.begin, log);
  run.begin.reset();
  progress.begin();
  const auto checkpoint = [&] {
    result.wall_seconds = seconds();
    return checkpoint_of(run);
  };
  Runner runner(run.simulation, "production", progress, saver, checkpoint,
                [&] { run.events.keep_up(run.simulation, log); });
  for (bool end = result.precise; !end && !result.stopped;) {
    const double next = run.observables.next_time();
    const double target = std::min(next, result.planned);
    result.stopped = !run_to(target, run, runner, log);
    if (result.stopped) break;
    if (next <= result.planned) run.observables.measure(run.simulation);
    end = target == result.planned && run.observables.next_time() > result.planned;
    if (config.target_error && target >= result.next_look) end = look_at_errors(config, run, log) || end;
    result.time = target;
  }
  if (!result.stopped) run.trajectory.take_last(run.simulation, result.time, log);
  result.results = run.observables.results(run.simulation);
  result.wall_seconds = seconds();
  if (result.stopped) result.time = run.simulation.time();
  result.envelope = run.simulation.envelope();
  result.counters = run.simulation.counters();
  result.failures = run.simulation.failures();
  log.line(fmt::format("production: {} at {:g} time units, {} collisions in {:.3f} s",
                       result.stopped ? "stopped" : "done", result.time, result.counters.collisions,
                       result.wall_seconds));
}

}  // namespace hardbody
