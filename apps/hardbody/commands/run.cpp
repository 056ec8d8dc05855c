#include "base/console.h"
#include "base/errors.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/signals.h"
#include "base/version.h"
#include "commands/commands.h"
#include "config/config.h"
#include "config/keys.h"
#include "config/text.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "io/toml_document.h"
#include "run/checkpoint.h"
#include "run/files/failure_file.h"
#include "run/files/observable_files.h"
#include "run/phases/equilibration.h"
#include "run/phases/production.h"
#include "run/record.h"
#include "run/saver.h"
#include "run/summary.h"
#include "run/table.h"
#include "start/agreement.h"
#include "start/from_file.h"
#include "start/make_start.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <exception>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

Config read_config(const RunArguments& arguments, std::optional<StartFrame>& frame) {
  if (!arguments.text) return load_config(arguments.config, arguments.overrides, &frame);
  return hardbody::read_config(read_toml(*arguments.text, arguments.config, arguments.overrides, Lines::unnamed),
                               &frame);
}

/// Returns the last state of the run that the config starts from. Throws InputError if there is none, or it is not one
/// of the config's bodies at its packing fraction or below.
ed::System read_origin_state(const Config& config) {
  const std::filesystem::path file = std::filesystem::path(*config.start_from) / kCheckpointFile;
  const Checkpoint checkpoint = read_checkpoint(file);
  const auto refuse = [&](const std::string& why, const std::string& accepted) {
    return InputError(fmt::format("{}: {} {}; accepted: {}", kStartFromKey, file.string(), why, accepted));
  };
  if (!checkpoint.run || !checkpoint.run->finished) {
    throw refuse("is of a run that is not finished", "the directory of a finished run");
  }
  const Agreement same = compare(checkpoint.system, config);
  if (!same.number) {
    throw refuse(fmt::format("holds {} bodies, {} is {}", checkpoint.system.size(), kNumberKey, config.number),
                 "a run of as many");
  }
  if (!same.shape) throw refuse("holds bodies of another shape", "a run of the same bodies");
  if (!same.dynamics) throw refuse("holds bodies of other mass or inertia", "a run of the same bodies");
  const double phi = ed::packing_fraction(checkpoint.system);
  if (phi > config.packing_fraction * (1 + kStateRounding)) {
    throw refuse(fmt::format("has packing fraction {:g}, {} is {:g}", phi, kPackingKey, config.packing_fraction),
                 "a run that is not denser");
  }
  return checkpoint.system;
}

/// Reads the state that the run starts from, before anything is changed. The name of its run becomes an absolute one.
ed::System take_origin(const std::filesystem::path& directory, Config& config) {
  ed::System origin = read_origin_state(config);
  std::error_code ignored;
  if (std::filesystem::equivalent(*config.start_from, directory, ignored)) {
    throw InputError(fmt::format("{}: {} is the directory of this run; accepted: that of another one", kStartFromKey,
                                 *config.start_from));
  }
  config.start_from = absolute_path(*config.start_from).string();
  return origin;
}

RunDirectory create_directory(const RunArguments& arguments, const Config& config) {
  const Overwrite overwrite = arguments.force ? Overwrite::allowed : Overwrite::refused;
  std::vector<std::filesystem::path> inputs;
  if (!arguments.text) inputs.emplace_back(arguments.config);
  if (config.start_file) inputs.emplace_back(config.start_file->file);
  return RunDirectory::create(directory_for(arguments.out, arguments.config), overwrite, inputs, resolved_text(config));
}

void write_failures(const RunDirectory& directory, const RunRecord& record, Log& log) {
  int count = 0;
  const Equilibration& before = record.equilibration;
  for (const auto* failures : {&before.failures_of_start, &before.failures, &record.production.failures}) {
    for (const ed::FailedPair& pair : *failures) {
      directory.write(fmt::format("{}/pair_{:02}.json", kFailuresDirectory, ++count),
                      failure_json({ed::to_string(pair.reason), pair, {}}));
    }
  }
  const std::uint64_t left_out = record.failures_left_out();
  if (left_out > 0)
    log.line(fmt::format("failures: {} pairs in {}/, {} more left out", count, kFailuresDirectory, left_out));
}

/// State at which a run begins, or is continued.
struct Continuation {
  LoadedStates loaded;
  std::optional<Start> start;
  std::optional<EquilibrationRun> equilibration;
  std::optional<ProductionRun> production;
  FilesMark files;
  Upkeep upkeep;
};

/// Returns the final state of the run.
Checkpoint last_checkpoint(Continuation& at, const RunRecord& record) {
  Checkpoint checkpoint = at.production      ? checkpoint_of(*at.production)
                          : at.equilibration ? checkpoint_of(*at.equilibration)
                                             : checkpoint_of(*at.start);
  if (checkpoint.run) checkpoint.run->finished = !record.stopped();
  return checkpoint;
}

/// Files of a run's end that have been written, in the order in which the results table names them.
struct WrittenFiles {
  bool summary = false;
  bool observables = false;
  bool checkpoint = false;  ///< the checkpoint, and with it the files that grow with the run

  std::vector<std::string> list(const RunDirectory& directory, const Config& config) const {
    std::vector<std::string> names;
    const auto add = [&](bool written, const char* name) {
      if (written) names.push_back(directory.file(name).string());
    };
    add(summary, kSummaryFile);
    add(observables, "observables/*.csv");
    add(checkpoint, kCheckpointFile);
    add(checkpoint && config.events > 0, kEventsFile);
    add(checkpoint && !config.trajectory.empty(), "trajectory.*");
    return names;
  }
};

/// Writes the results. The summary comes last: if it exists, the other files are complete.
void write_results(const RunDirectory& directory, RunRecord& record, Continuation& at, Saver& saver, Log& log,
                   WrittenFiles& written) {
  const ed::Results& results = record.production.results;
  saver.write(last_checkpoint(at, record));
  written.checkpoint = true;
  for (const CurveFile& file : curve_files()) directory.write(file.path(), curve_csv(file, results));
  written.observables = true;
  write_failures(directory, record, log);
  record.upkeep = saver.upkeep();
  directory.write(kSummaryFile, summary_json(record));
  written.summary = true;
}

/// Logs a line and prints it after the name of the run.
void announce(const std::string& text, const RunDirectory& directory, Progress& progress, Log& log) {
  log.line(text);
  progress.say(fmt::format("{}: {}", directory.path().string(), text));
}

/// Ends a run without a start. Nothing was measured, and an incomplete start is not kept: only the config and the log
/// remain.
int stopped_at_the_start(const RunDirectory& directory, Progress& progress, Log& log) {
  const int signal = pending_signal();
  announce(
      fmt::format("stopped by {} during the start: nothing was measured, and the start is not saved: hardbody resume "
                  "begins it again",
                  signal_name(signal)),
      directory, progress, log);
  return exit_status_of(signal);
}

int conclude(const RunDirectory& directory, RunRecord& record, Continuation& at, Saver& saver, Progress& progress,
             Log& log) {
  const int signal = pending_signal();
  std::exception_ptr failure;
  WrittenFiles written;
  try {
    write_results(directory, record, at, saver, log, written);
    log.line("files written");
  } catch (const std::exception&) {
    failure = std::current_exception();
  }
  progress.clear();
  // The table is printed even if a full disk has kept the files from being written: it may be the result of hours of
  // work.
  console().print(results_table(record, written.list(directory, record.config)));
  if (failure) std::rethrow_exception(failure);
  const std::vector<std::string> list = defects(record);
  for (const std::string& defect : list) announce("NOT SOUND: " + defect, directory, progress, log);
  if (record.stopped() && !record.stall) {
    announce(fmt::format("stopped by {} during {} at time {:g}: results so far are written, hardbody resume continues",
                         signal_name(signal), record.last_phase(), record.last_time()),
             directory, progress, log);
    return exit_status_of(signal);
  }
  log.line("end");
  return list.empty() ? 0 : 1;
}

/// Brings the run to the begin of equilibration, from its current state; returns false if a signal came before there
/// was a start.
bool prepare(const Config& config, Continuation& at, Progress& progress, Saver& saver, Log& log) {
  if (at.equilibration || at.production) return true;
  if (!at.start) {
    if (config.start_from && !at.loaded.origin) at.loaded.origin = read_origin_state(config);
    at.start = make_start(config, std::exchange(at.loaded, {}), progress, log);
  }
  if (!at.start) return false;
  // The run or file that it started from may be gone, or another one, when this run is resumed.
  if (saver.due() || config.start_from || config.start_file) saver.save([&at] { return checkpoint_of(*at.start); });
  at.equilibration = begin_equilibration(config, *at.start, progress, saver, log);
  if (at.equilibration && config.equilibration_time != 0.0) at.start.reset();
  return true;
}

void run_equilibration(const Config& config, const RunDirectory& directory, Continuation& at, RunRecord& record,
                       Progress& progress, Saver& saver, Log& log) {
  record.equilibration = equilibrate(config, *at.equilibration, progress, saver, log);
  // If there was no equilibration, the start itself, to the last bit.
  if (at.start) record.equilibration.system = std::exchange(at.start, std::nullopt)->system;
  record.stall = at.equilibration->simulation.stall();
  // A state with an overlap cannot start a production run.
  const bool sound = defects(ed::audit(record.equilibration.system)).empty();
  if (record.equilibration.stopped || !sound) return;
  at.equilibration.reset();
  at.production = begin_production(config, std::move(record.equilibration), directory, log);
}

void run_production(const Config& config, Continuation& at, RunRecord& record, Progress& progress, Saver& saver,
                    Log& log) {
  produce(config, *at.production, at.files, progress, saver, log);
  record.equilibration = at.production->before;
  record.production = at.production->result;
  record.production.system = at.production->simulation.system();
  record.stall = at.production->simulation.stall();
}

int run_phases(const Config& config, const RunDirectory& directory, Continuation at, Log& log) {
  Progress progress;
  Saver saver(directory, config, at.upkeep, progress, log);
  if (!prepare(config, at, progress, saver, log)) return stopped_at_the_start(directory, progress, log);
  RunRecord record;
  record.config = config;
  if (at.equilibration) run_equilibration(config, directory, at, record, progress, saver, log);
  if (at.production) run_production(config, at, record, progress, saver, log);
  if (!at.equilibration && !at.production) {  // a signal came while the neighbour lists were tuned
    record.equilibration.system = at.start->system;
    record.equilibration.counters_of_start = at.start->counters;
    record.equilibration.failures_of_start = at.start->failures;
    record.equilibration.kinetic_at_start = ed::kinetic_state(at.start->system);
    record.equilibration.stopped = true;
  }
  audit_record(record);
  return conclude(directory, record, at, saver, progress, log);
}

/// Returns what to do when a file could not be written.
std::string advice(const RunDirectory& directory, const WriteError& error) {
  return fmt::format("{}: {}, then hardbody resume {}{}",
                     directory.has(kCheckpointFile) ? "the last checkpoint is intact" : "there is no checkpoint yet",
                     error.no_room() ? "free some room" : "resolve this", directory.path().string(),
                     directory.has(kCheckpointFile) ? "" : " starts over");
}

int run_logged(const Config& config, const RunDirectory& directory, Continuation at, Log& log) {
  try {
    return run_phases(config, directory, std::move(at), log);
  } catch (const WriteError& error) {
    const std::string text = fmt::format("{}; {}", error.what(), advice(directory, error));
    log.line("failed: " + text);
    throw std::runtime_error(text);
  } catch (const std::exception& error) {
    log.line(fmt::format("failed: {}", error.what()));
    throw;
  }
}

// ---- Resuming

/// Makes the state to continue from. All errors are detected here, before anything is changed.
Continuation continuation(const Config& config, Checkpoint checkpoint, const RunDirectory& directory,
                          const std::string& name) {
  Continuation at;
  at.upkeep = checkpoint.upkeep;
  ++at.upkeep.resumed;
  if (checkpoint.phase == "start") {
    at.start = Start{std::move(checkpoint.system), checkpoint.counters_of_start, checkpoint.failures_of_start};
  } else if (checkpoint.phase == "equilibration") {
    at.equilibration = resumed_equilibration(config, checkpoint, name);
  } else if (checkpoint.phase != "production") {
    throw InputError(fmt::format("{}: holds an impossible state (phase \"{}\"); accepted: an undamaged checkpoint",
                                 name, one_line(checkpoint.phase, 40)));
  } else {
    at.production = resumed_production(config, checkpoint, directory, name);
    at.files = checkpoint.run->files;
  }
  return at;
}

/// Returns whether the directory has the results of a run that was not interrupted.
bool has_final_results(const RunDirectory& directory) {
  if (!directory.has(kSummaryFile)) return false;
  const std::string text = read_file(directory.file(kSummaryFile), kLongestSummary);
  const nlohmann::json summary = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  return summary.is_object() && summary.value("interrupted", nlohmann::json()) == false;
}

/// Reports that the run is complete. Nothing is changed.
int leave_alone(const RunDirectory& directory) {
  console().print(fmt::format("{}: the run is finished: nothing to do\n", directory.path().string()));
  return 0;
}

/// Starts a run without a checkpoint again, which gives the same run bit for bit.
int start_over(const RunDirectory& directory) {
  const Config config = load_config(directory.file(kConfigFile).string(), {});
  directory.check_writable();
  directory.reopen();
  Log log(directory.file(kLogFile), Log::Begin::at_the_end);
  log.line(fmt::format("hardbody {}: resumed without a checkpoint: starts over", version()));
  return run_logged(config, directory, {}, log);
}

}  // namespace

int run(const RunArguments& arguments) {
  std::optional<StartFrame> frame;
  Config config = read_config(arguments, frame);
  install_signal_handlers();
  // Errors of a state to start from are reported before anything is written.
  Continuation at;
  if (config.start_from) at.loaded.origin = take_origin(directory_for(arguments.out, arguments.config), config);
  if (config.start_file) {
    at.loaded.file = start_from_file(config, std::exchange(frame, std::nullopt));
    config.packing_fraction = ed::packing_fraction(at.loaded.file->system);
  }
  const RunDirectory directory = create_directory(arguments, config);
  Log log(directory.file(kLogFile), Log::Begin::afresh);
  log.line(fmt::format("hardbody {}: {} with {}", version(), kConfigFile, arguments.config));
  return run_logged(config, directory, std::move(at), log);
}

int resume(const std::string& path) {
  install_signal_handlers();
  const RunDirectory directory = RunDirectory::open(path);
  const bool final = has_final_results(directory);
  if (!directory.has(kCheckpointFile)) return final ? leave_alone(directory) : start_over(directory);
  const std::string name = directory.file(kCheckpointFile).string();
  std::optional<Checkpoint> checkpoint;
  // For a finished run it does not matter which program could continue it. Otherwise that is checked before the config,
  // which may have another version's keys.
  try {
    checkpoint = read_checkpoint(name);
    check_version(*checkpoint, name);
  } catch (const OtherVersion&) {
    if (final) return leave_alone(directory);
    throw;
  }
  const std::string config_name = directory.file(kConfigFile).string();
  const Config config = load_config(config_name, {});
  check_same_config(*checkpoint, config, config_name);
  if (final || (checkpoint->run && checkpoint->run->finished && directory.has(kSummaryFile)))
    return leave_alone(directory);
  check_resumable(*checkpoint, name);
  directory.check_writable();
  const std::string from = fmt::format("{} at time {:g}", checkpoint->phase, checkpoint->time);
  Continuation at = continuation(config, std::move(*checkpoint), directory, name);
  checkpoint.reset();
  directory.reopen();
  Log log(directory.file(kLogFile), Log::Begin::at_the_end);
  log.line(fmt::format("hardbody {}: resumed from {}", version(), from));
  return run_logged(config, directory, std::move(at), log);
}

}  // namespace hardbody
