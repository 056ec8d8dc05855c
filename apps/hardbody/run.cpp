#include "commands.h"
#include "config.h"
#include "config_text.h"
#include "errors.h"
#include "failure_file.h"
#include "log.h"
#include "observable_files.h"
#include "phases.h"
#include "progress.h"
#include "run_directory.h"
#include "run_record.h"
#include "saver.h"
#include "signals.h"
#include "summary.h"
#include "table.h"
#include "version.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>

namespace hardbody {
namespace {

std::filesystem::path directory_for(const RunArguments& arguments) {
  if (arguments.out && arguments.out->empty()) throw InputError("--out is empty; accepted: the name of a directory");
  if (arguments.out) return *arguments.out;
  return std::filesystem::path("out") / std::filesystem::path(arguments.config).stem();
}

RunDirectory create_directory(const RunArguments& arguments, const Config& config) {
  const Overwrite overwrite = arguments.force ? Overwrite::allowed : Overwrite::refused;
  return RunDirectory::create(directory_for(arguments), overwrite, arguments.config, resolved_text(config));
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

/// The summary comes last: where it is, the other files are complete.
void write_results(const RunDirectory& directory, const RunRecord& record, const Saver& saver, Log& log) {
  const ed::Results& results = record.production.results;
  saver.write(record.last_state(), record.last_time());
  directory.write(kMsdFile, msd_csv(results));
  directory.write(kRotationalMsdFile, rotational_msd_csv(results));
  directory.write(kC2File, c2_csv(results));
  directory.write(kBlocksFile, blocks_csv(results));
  if (record.config.events > 0) directory.write(kEventsFile, events_csv(record.production.collisions));
  write_failures(directory, record, log);
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

int conclude(const RunDirectory& directory, const RunRecord& record, const Saver& saver, Progress& progress, Log& log) {
  const int signal = pending_signal();
  std::exception_ptr failure;
  try {
    write_results(directory, record, saver, log);
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
  if (record.stopped()) {
    const std::string text = fmt::format("stopped by {} during {} at time {:g}: what was measured is written",
                                         signal_name(signal), record.last_phase(), record.last_time());
    log.line(text);
    progress.say(fmt::format("{}: {}", directory.path().string(), text));
    return exit_status_of(signal);
  }
  log.line("end");
  return list.empty() ? 0 : 1;
}

int run_phases(const Config& config, const RunDirectory& directory, Log& log) {
  Progress progress;
  const std::optional<ed::System> start = make_start(config, progress, log);
  if (!start) return stopped_at_the_start(directory, progress, log);
  Saver saver(directory, config, progress, log);
  RunRecord record;
  record.config = config;
  record.equilibration = equilibrate(config, *start, progress, saver, log);
  // A state with an overlap is no start for a production run.
  const bool sound = defects(ed::audit(record.equilibration.system)).empty();
  if (!record.equilibration.stopped && sound) {
    record.production = produce(config, record.equilibration, progress, saver, log);
  }
  audit_record(record);
  record.total_seconds = log.seconds();
  return conclude(directory, record, saver, progress, log);
}

}  // namespace

int run(const RunArguments& arguments) {
  install_signal_handlers();
  const Config config = load_config(arguments.config, arguments.overrides);
  const RunDirectory directory = create_directory(arguments, config);
  Log log(directory.file(kLogFile));
  log.line(fmt::format("hardbody {}: {} with {}", version(), kConfigFile, arguments.config));
  try {
    return run_phases(config, directory, log);
  } catch (const std::exception& error) {
    log.line(fmt::format("failed: {}", error.what()));
    throw;
  }
}

}  // namespace hardbody
