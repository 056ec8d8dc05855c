#include "run/phases/production.h"

#include "run/phases/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

/// "auto": production in units of the equilibration time, and its limits. Times are in units of Config::time_unit.
constexpr double kProductionFactor = 30;
/// Longest lag of "auto" where production is long and the equilibration was shorter: the relaxation is over by then,
/// and longer lags would only add to the errors of diffusion coefficients.
constexpr double kLagOfAuto = 40;
/// Least longest lag of "auto", in collisions of a body. Diffusion coefficients are fitted from 0.4 of it on, and a
/// velocity is forgotten in about 1.5 collisions, so that exp(-7) of it is left there.
constexpr double kLagCollisions = 25;
/// Longest lags that production lasts, at least. With a target error it is asked for then, and again each time that the
/// run has grown by a factor.
constexpr double kLags = 16;
constexpr double kNextLook = 1.25;

/// kLagCollisions mean collision intervals; 0 if nothing is known of them.
double dilute_lag(const Config& config, double equilibration_time, double collisions) {
  return collisions > 0 ? kLagCollisions * equilibration_time * config.number / (2 * collisions) : 0;
}

/// Returns the usual length of a production without a target error.
double usual_length(const Config& config, double equilibration_time) {
  const double unit = config.time_unit;
  return std::clamp(kProductionFactor * equilibration_time, kLeastProduction * unit, kMostProduction * unit);
}

/// Returns the time of the first test of a target error.
double first_look(const Production& plan) {
  return std::min(kLags * plan.longest_lag, plan.planned);
}

/// Plans the length of production and what is measured in it.
Production planned_production(const Config& config, const Equilibration& equilibration) {
  Production plan;
  const ProductionTimes times =
      production_times(config, equilibration.time, static_cast<double>(equilibration.counters.collisions));
  plan.longest_lag = times.longest_lag;
  plan.planned = config.production_time || !config.target_error ? times.length : kMostProduction * config.time_unit;
  plan.next_look = first_look(plan);
  const double q = equilibration.relaxation.q;
  plan.wave_numbers = config.wave_numbers;
  if (plan.wave_numbers.empty()) plan.wave_numbers = ed::wave_numbers_about(q);
  return plan;
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

ed::ObservablesOptions observables_options(const Config& config, const Production& production) {
  ed::ObservablesOptions options{};
  options.number = config.number;
  options.duration = production.planned > 0 ? production.planned : config.time_unit;  // of none nothing is measured
  options.time_unit = config.time_unit;
  options.longest_lag = production.longest_lag;
  options.wave_numbers = production.wave_numbers;
  options.groups = config.groups();
  options.collective = config.collective;
  options.bonds = config.bonds();
  return options;
}

/// Runs to `time`, taking the frames that are due until then; false if the run was stopped before.
bool run_to(double time, ProductionRun& run, Runner& runner, Log& log) {
  const double planned = run.result.planned;
  while (run.trajectory.next_time() <= time) {
    if (!runner.run_to(run.trajectory.next_time(), planned)) return false;
    run.trajectory.take(run.simulation, log);
  }
  return runner.run_to(time, planned);
}

/// Returns whether a run with a target error gains nothing by going on. It is asked at times that do not depend on a
/// clock. A coefficient that has no value after a production of the usual length will not get one: motion is ballistic
/// up to the longest lag, as the rotation of what is nearly a sphere, or arrested.
bool look_at_errors(const Config& config, ProductionRun& run, Log& log) {
  run.result.next_look *= kNextLook;
  const std::vector<ed::Estimate> wanted = wanted_coefficients(config, run.observables.results(run.simulation));
  const auto precise = [&](const ed::Estimate& D) { return precise_enough(D, *config.target_error); };
  run.result.precise = std::all_of(wanted.begin(), wanted.end(), precise);
  if (run.result.precise) return true;
  const auto hopeless = [&](const ed::Estimate& D) { return !std::isfinite(D.value); };
  if (run.simulation.time() < usual_length(config, run.before.time)) return false;
  if (!std::all_of(wanted.begin(), wanted.end(), [&](const auto& D) { return precise(D) || hopeless(D); }))
    return false;
  log.line(
      fmt::format("production: no {} at lags up to {:g}, motion is not diffusive there: target_error is not reached",
                  hopeless(wanted[0]) ? "D_trans" : "D_rot", run.result.longest_lag));
  return true;
}

}  // namespace

ProductionTimes production_times(const Config& config, double equilibration_time, double collisions) {
  if (config.production_time) {
    return {*config.production_time, config.longest_lag.value_or(*config.production_time / kLags)};
  }
  const double unit = config.time_unit;
  const double usual = usual_length(config, equilibration_time);
  // A state that was slow to equilibrate decays as slowly.
  const double lag = std::min(usual / kLags, std::max(kLagOfAuto * unit, equilibration_time));
  const double dilute = std::min(dilute_lag(config, equilibration_time, collisions), kMostProduction * unit / kLags);
  const double longest_lag = config.longest_lag.value_or(std::max(lag, dilute));
  const double length = config.target_error ? kLags * longest_lag : std::max(kLags * longest_lag, usual);
  return {std::min(length, kMostProduction * unit), longest_lag};
}

ProductionRun begin_production(const Config& config, Equilibration equilibration, const RunDirectory& directory,
                               Log& log) {
  Production production = planned_production(config, equilibration);
  log.line(config.target_error ? fmt::format("production: until the relative errors of both diffusion coefficients are "
                                             "{:g}, at most {:g} time units",
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
  run.events.check(state.files.events);
  run.trajectory.check(state.files.trajectory);
  return run;
}

Production extended_production(const Config& longer, const Production& production) {
  Production result = production;
  result.planned = *longer.production_time;
  result.next_look = first_look(result);
  result.precise = false;
  return result;
}

std::string extended_observables(const Config& config, const Config& longer, const RunState& state) {
  ed::Observables observables =
      ed::Observables::restore(state.observables.bytes(), observables_options(config, state.production));
  observables.extend(*longer.production_time);
  return observables.save();
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
  state.files = {run.events.mark(), run.trajectory.mark()};
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
