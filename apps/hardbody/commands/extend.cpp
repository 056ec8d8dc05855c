#include "base/errors.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/signals.h"
#include "base/version.h"
#include "commands/commands.h"
#include "commands/run_to_end.h"
#include "config/config.h"
#include "io/run_directory.h"
#include "run/checkpoint.h"
#include "run/extension.h"
#include "run/saver.h"
#include "run/summary.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <utility>

namespace hardbody {
namespace {

void refuse_sweep(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path / kSweepTableFile) || std::filesystem::exists(path / kConfigFile)) return;
  throw InputError(fmt::format(
      "{}: is the directory of a sweep, whose points are extended one by one; accepted: the directory of a point in it",
      path.string()));
}

/// Returns the last state of a run that has come to a sound end. Throws InputError for others.
Checkpoint finished_checkpoint(const RunDirectory& directory) {
  const std::string path = directory.path().string();
  const nlohmann::json summary = stored_summary(directory);
  if (summary.is_object() && !summary.value("stalled", nlohmann::json()).is_null()) {
    throw InputError(fmt::format("{}: the run has stalled (log.txt says where); accepted: a finished run", path));
  }
  const InputError unfinished(fmt::format(
      "{}: the run is not finished; accepted: a finished run: hardbody resume {} finishes this one", path, path));
  if (!directory.has(kCheckpointFile)) {
    if (summary.is_null()) throw unfinished;
    throw InputError(fmt::format("{}: {} is missing; accepted: a finished run with it", path, kCheckpointFile));
  }
  const std::string name = directory.file(kCheckpointFile).string();
  Checkpoint checkpoint = read_checkpoint(name);
  check_version(checkpoint, name);
  if (!checkpoint.run || !checkpoint.run->finished || summary.is_null()) throw unfinished;
  if (checkpoint.phase != "production" || summary.value("sound", nlohmann::json()) != true) {
    throw InputError(fmt::format("{}: the run is NOT SOUND (log.txt says why); accepted: a sound run", path));
  }
  check_resumable(checkpoint, name);
  return checkpoint;
}

/// Describes what the longer run is, with the lag that its config now names.
std::string extension_text(const Config& before, const Config& longer, double from) {
  const double time = *longer.production_time;
  std::string text = fmt::format("production is extended from {:g} to {:g} time units", from, time);
  if (!before.longest_lag) {
    text += fmt::format(
        "; correlations keep their longest lag: the run is that of production.time = {} and "
        "production.longest_lag = {}",
        time, *longer.longest_lag);
  }
  if (before.target_error) text += "; production.target_error no longer ends it";
  return text;
}

}  // namespace

int extend(const ExtendArguments& arguments) {
  install_signal_handlers();
  refuse_sweep(arguments.path);
  const RunDirectory directory = RunDirectory::open(arguments.path);
  complete_extension(directory);
  Checkpoint checkpoint = finished_checkpoint(directory);
  const std::string config_name = directory.file(kConfigFile).string();
  const Config config = load_config(config_name, {});
  check_same_config(checkpoint, config, config_name);
  const double from = checkpoint.run->production.time;
  const Config longer = extended_config(config, checkpoint.run->production, arguments.time);
  directory.check_writable();
  const std::string name = directory.file(kCheckpointFile).string();
  extend_checkpoint(config, longer, checkpoint, name);
  Continuation at = continuation(longer, checkpoint, directory, name);
  Log log(directory.file(kLogFile), Log::Begin::at_the_end);
  log.line(fmt::format("hardbody {}: extended", version()));
  {
    Progress progress;
    announce(fmt::format("{}: {}", directory.path().string(), extension_text(config, longer, from)), progress, log);
    Saver saver(directory, longer, at.upkeep, progress, log);
    store_extension(directory, longer, checkpoint, saver);
    ++at.upkeep.checkpoints;
  }
  checkpoint = {};
  return run_to_end(longer, directory, std::move(at), log);
}

}  // namespace hardbody
