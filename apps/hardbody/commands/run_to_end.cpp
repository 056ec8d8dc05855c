#include "commands/run_to_end.h"

#include "base/console.h"
#include "base/errors.h"
#include "base/progress.h"
#include "base/signals.h"
#include "config/keys.h"
#include "io/text_file.h"
#include "run/files/failure_file.h"
#include "run/files/observable_files.h"
#include "run/saver.h"
#include "run/summary.h"
#include "run/table.h"
#include "start/agreement.h"

#include <fmt/format.h>

#include <cstdint>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

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
  for (const CurveFile& file : curve_files()) {
    if (is_written(file, results)) directory.write(file.path(), curve_csv(file, results));
  }
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
    record.equilibration.packing_of_file = at.start->packing_of_file;
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

}  // namespace

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

Continuation continuation(const Config& config, Checkpoint checkpoint, const RunDirectory& directory,
                          const std::string& name) {
  Continuation at;
  at.upkeep = checkpoint.upkeep;
  ++at.upkeep.resumed;
  if (checkpoint.phase == "start") {
    at.start = Start{std::move(checkpoint.system), checkpoint.counters_of_start, checkpoint.failures_of_start,
                     checkpoint.packing_of_file};
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

int run_to_end(const Config& config, const RunDirectory& directory, Continuation at, Log& log) {
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

}  // namespace hardbody
