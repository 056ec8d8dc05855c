#include "checkpoint.h"
#include "commands.h"
#include "config.h"
#include "config_text.h"
#include "errors.h"
#include "failure_file.h"
#include "log.h"
#include "make_start.h"
#include "observable_files.h"
#include "origin.h"
#include "phases.h"
#include "progress.h"
#include "run_directory.h"
#include "run_record.h"
#include "saver.h"
#include "signals.h"
#include "start_file.h"
#include "summary.h"
#include "table.h"
#include "text_file.h"
#include "version.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

std::filesystem::path directory_for(const RunArguments& arguments) {
  if (arguments.out && arguments.out->empty()) throw InputError("--out is empty; accepted: the name of a directory");
  if (arguments.out) return *arguments.out;
  return std::filesystem::path("out") / std::filesystem::path(arguments.config).stem();
}

/// Before anything is changed. The name of the run becomes one that is good from everywhere.
void check_origin(const RunArguments& arguments, Config& config) {
  (void)read_origin_state(config);
  std::error_code ignored;
  if (std::filesystem::equivalent(*config.start_from, directory_for(arguments), ignored)) {
    throw InputError(fmt::format("system.start_from: {} is the directory of this run; accepted: that of another one",
                                 *config.start_from));
  }
  config.start_from = std::filesystem::absolute(*config.start_from).lexically_normal().string();
}

RunDirectory create_directory(const RunArguments& arguments, const Config& config) {
  const Overwrite overwrite = arguments.force ? Overwrite::allowed : Overwrite::refused;
  std::vector<std::filesystem::path> inputs = {arguments.config};
  if (config.start_file) inputs.emplace_back(config.start_file->file);
  return RunDirectory::create(directory_for(arguments), overwrite, inputs, resolved_text(config));
}

void write_failures(const RunDirectory& directory, const RunRecord& record, Log& log) {
  int count = 0;
  for (const auto* failures : {&record.equilibration.failures, &record.production.failures}) {
    for (const ed::FailedPair& pair : *failures) {
      directory.write(fmt::format("{}/pair_{:02}.json", kFailuresDirectory, ++count),
                      failure_json({ed::to_string(pair.reason), pair}));
    }
  }
  const std::uint64_t left_out = record.failures_left_out();
  if (left_out > 0)
    log.line(fmt::format("failures: {} pairs in {}/, {} more left out", count, kFailuresDirectory, left_out));
}

/// Where a run begins, or goes on.
struct Continuation {
  std::optional<Start> start;
  std::optional<EquilibrationRun> equilibration;
  std::optional<ProductionRun> production;
  FilesMark files;
  Upkeep upkeep;
};

/// The state in which the run has ended.
Checkpoint last_checkpoint(Continuation& at, const RunRecord& record) {
  Checkpoint checkpoint = at.production      ? checkpoint_of(*at.production)
                          : at.equilibration ? checkpoint_of(*at.equilibration)
                                             : checkpoint_of(*at.start);
  if (checkpoint.run) checkpoint.run->finished = !record.stopped();
  return checkpoint;
}

/// The summary comes last: where it is, the other files are complete.
void write_results(const RunDirectory& directory, RunRecord& record, Continuation& at, Saver& saver, Log& log) {
  const ed::Results& results = record.production.results;
  saver.write(last_checkpoint(at, record));
  directory.write(kMsdFile, msd_csv(results));
  directory.write(kRotationalMsdFile, rotational_msd_csv(results));
  directory.write(kAlpha2File, alpha2_csv(results));
  directory.write(kVelocityFile, velocity_csv(results));
  directory.write(kC1File, c1_csv(results));
  directory.write(kC2File, c2_csv(results));
  directory.write(kFSelfFile, f_self_csv(results));
  directory.write(kPairsFile, pairs_csv(results));
  directory.write(kStructureFile, structure_csv(results));
  directory.write(kBlocksFile, blocks_csv(results));
  write_failures(directory, record, log);
  record.upkeep = saver.upkeep();
  directory.write(kSummaryFile, summary_json(record));
}

/// Nothing was measured: only the config and the log stay.
int stopped_at_the_start(const RunDirectory& directory, Progress& progress, Log& log) {
  const int signal = pending_signal();
  const std::string text = fmt::format("stopped by {} during the start: nothing was measured", signal_name(signal));
  log.line(text);
  progress.say(fmt::format("{}: {}", directory.path().string(), text));
  return exit_status_of(signal);
}

int conclude(const RunDirectory& directory, RunRecord& record, Continuation& at, Saver& saver, Progress& progress,
             Log& log) {
  const int signal = pending_signal();
  std::exception_ptr failure;
  try {
    write_results(directory, record, at, saver, log);
    log.line("files written");
  } catch (const std::exception&) {
    failure = std::current_exception();
  }
  progress.clear();
  // The table also when a full disk has kept the files from being written: hours of work may stand in it.
  (void)std::fputs(results_table(record, directory.path().string()).c_str(), stdout);
  (void)std::fflush(stdout);
  if (failure) std::rethrow_exception(failure);
  const std::vector<std::string> list = defects(record);
  for (const std::string& defect : list) {
    log.line("NOT SOUND: " + defect);
    progress.say(fmt::format("{}: NOT SOUND: {}", directory.path().string(), defect));
  }
  if (record.stopped() && !record.stall) {
    const std::string text =
        fmt::format("stopped by {} during {} at time {:g}: what was measured is written, hardbody resume goes on",
                    signal_name(signal), record.last_phase(), record.last_time());
    log.line(text);
    progress.say(fmt::format("{}: {}", directory.path().string(), text));
    return exit_status_of(signal);
  }
  log.line("end");
  return list.empty() ? 0 : 1;
}

/// Up to the begin of equilibration, from wherever the run stands; false: a signal came before there was a start.
bool prepare(const Config& config, Continuation& at, Progress& progress, Saver& saver, Log& log) {
  if (at.equilibration || at.production) return true;
  if (!at.start) at.start = make_start(config, progress, log);
  if (!at.start) return false;
  // The run that it came from may be gone when this one is resumed.
  if (saver.due() || config.start_from) saver.save([&at] { return checkpoint_of(*at.start); });
  at.equilibration = begin_equilibration(config, *at.start, progress, saver, log);
  if (at.equilibration && config.equilibration_time != 0.0) at.start.reset();
  return true;
}

void run_equilibration(const Config& config, const RunDirectory& directory, Continuation& at, RunRecord& record,
                       Progress& progress, Saver& saver, Log& log) {
  record.equilibration = equilibrate(config, *at.equilibration, progress, saver, log);
  // Where nothing was to run the start itself, to the last bit.
  if (at.start) record.equilibration.system = std::exchange(at.start, std::nullopt)->system;
  record.stall = at.equilibration->simulation.stall();
  // A state with an overlap is no start for a production run.
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
  if (!at.equilibration && !at.production) {  // a signal came while the lists were tuned
    record.equilibration.system = at.start->system;
    record.equilibration.counters_of_start = at.start->counters;
    record.equilibration.kinetic_at_start = ed::kinetic_state(at.start->system);
    record.equilibration.stopped = true;
  }
  audit_record(record);
  return conclude(directory, record, at, saver, progress, log);
}

int run_logged(const Config& config, const RunDirectory& directory, Continuation at, Log& log) {
  try {
    return run_phases(config, directory, std::move(at), log);
  } catch (const std::exception& error) {
    log.line(fmt::format("failed: {}", error.what()));
    throw;
  }
}

// ---- Resuming

/// Everything that can be refused is refused here, before anything is changed.
Continuation continuation(const Config& config, const Checkpoint& checkpoint, const RunDirectory& directory,
                          const std::string& name) {
  Continuation at;
  at.upkeep = checkpoint.upkeep;
  ++at.upkeep.resumed;
  if (checkpoint.phase == "start") {
    at.start = Start{checkpoint.system, checkpoint.counters_of_start};
  } else if (checkpoint.phase == "equilibration") {
    at.equilibration = resumed_equilibration(config, checkpoint, name);
  } else if (checkpoint.phase != "production") {
    throw InputError(fmt::format("{}: holds an impossible state (phase \"{}\"); accepted: an undamaged checkpoint",
                                 name, one_line(checkpoint.phase, 40)));
  } else {
    at.production = resumed_production(config, checkpoint, directory, name);
    at.files = {checkpoint.run->events, checkpoint.run->trajectory};
  }
  return at;
}

/// Without a checkpoint: the same run again, which is the same to every bit.
int start_over(const Config& config, const RunDirectory& directory) {
  if (directory.has(kSummaryFile)) {
    throw InputError(fmt::format("{}: holds results but no {}; accepted: a run that was stopped or killed",
                                 directory.path().string(), kCheckpointFile));
  }
  Log log(directory.file(kLogFile), Log::Begin::at_the_end);
  log.line(fmt::format("hardbody {}: resumed without a checkpoint: starts over", version()));
  return run_logged(config, directory, {}, log);
}

}  // namespace

int run(const RunArguments& arguments) {
  Config config = load_config(arguments.config, arguments.overrides);
  install_signal_handlers();
  if (config.start_from) check_origin(arguments, config);
  // What is wrong with the file is said before anything is written.
  if (config.start_file) config.packing_fraction = ed::packing_fraction(start_from_file(config).system);
  const RunDirectory directory = create_directory(arguments, config);
  Log log(directory.file(kLogFile), Log::Begin::afresh);
  log.line(fmt::format("hardbody {}: {} with {}", version(), kConfigFile, arguments.config));
  return run_logged(config, directory, {}, log);
}

int resume(const std::string& path) {
  install_signal_handlers();
  const RunDirectory directory = RunDirectory::open(path);
  const std::string config_name = directory.file(kConfigFile).string();
  const Config config = load_config(config_name, {});
  if (!directory.has(kCheckpointFile)) return start_over(config, directory);
  const std::string name = directory.file(kCheckpointFile).string();
  const Checkpoint checkpoint = read_checkpoint(name);
  check_same_config(checkpoint, config, config_name);
  if (checkpoint.run && checkpoint.run->finished && directory.has(kSummaryFile)) {
    fmt::print("{}: the run is finished: nothing to do\n", path);
    return 0;
  }
  check_resumable(checkpoint, name);
  Continuation at = continuation(config, checkpoint, directory, name);
  directory.reopen();
  Log log(directory.file(kLogFile), Log::Begin::at_the_end);
  log.line(fmt::format("hardbody {}: resumed from {} at time {:g}", version(), checkpoint.phase, checkpoint.time));
  return run_logged(config, directory, std::move(at), log);
}

}  // namespace hardbody
