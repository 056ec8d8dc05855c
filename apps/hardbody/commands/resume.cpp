#include "base/console.h"
#include "base/errors.h"
#include "base/log.h"
#include "base/signals.h"
#include "base/version.h"
#include "commands/commands.h"
#include "commands/run_to_end.h"
#include "config/config.h"
#include "config/keys.h"
#include "config/text.h"
#include "io/run_directory.h"
#include "run/checkpoint.h"
#include "run/extension.h"
#include "run/summary.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

using Overrides = std::vector<std::string>;  // section.key=value

/// Returns whether the directory has the results of a run that was not interrupted.
bool has_final_results(const RunDirectory& directory) {
  const nlohmann::json summary = stored_summary(directory);
  return summary.is_object() && summary.value("interrupted", nlohmann::json()) == false;
}

/// Reports that the run is complete. Nothing is changed.
int leave_alone(const RunDirectory& directory) {
  console().print(fmt::format("{}: the run is finished: nothing to do\n", directory.path().string()));
  return 0;
}

/// Stores the config, if it is not the one that is there, and removes the summary.
void reopen(const RunDirectory& directory, const Config& config, const Overrides& overrides) {
  if (!overrides.empty()) directory.write(kConfigFile, resolved_text(config));
  directory.reopen();
}

/// Starts a run without a checkpoint again, which gives the same run bit for bit.
int start_over(const RunDirectory& directory, const Overrides& overrides) {
  const Config config = load_config(directory.file(kConfigFile).string(), overrides);
  directory.check_writable();
  reopen(directory, config, overrides);
  Log log(directory.file(kLogFile), Log::Begin::at_the_end);
  log.line(fmt::format("hardbody {}: resumed without a checkpoint: starts over", version()));
  return run_to_end(config, directory, {}, log);
}

}  // namespace

int resume(const ResumeArguments& arguments) {
  check_may_change(arguments.overrides);
  install_signal_handlers();
  const RunDirectory directory = RunDirectory::open(arguments.path);
  complete_extension(directory);
  const bool final = has_final_results(directory);
  if (!directory.has(kCheckpointFile))
    return final ? leave_alone(directory) : start_over(directory, arguments.overrides);
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
  const Config config = load_config(config_name, arguments.overrides);
  check_same_config(*checkpoint, config, config_name);
  if (final || (checkpoint->run && checkpoint->run->finished && directory.has(kSummaryFile)))
    return leave_alone(directory);
  check_resumable(*checkpoint, name);
  directory.check_writable();
  const std::string from = fmt::format("{} at time {:g}", checkpoint->phase, checkpoint->time);
  Continuation at = continuation(config, std::move(*checkpoint), directory, name);
  checkpoint.reset();
  reopen(directory, config, arguments.overrides);
  Log log(directory.file(kLogFile), Log::Begin::at_the_end);
  log.line(fmt::format("hardbody {}: resumed from {}", version(), from));
  return run_to_end(config, directory, std::move(at), log);
}

}  // namespace hardbody
