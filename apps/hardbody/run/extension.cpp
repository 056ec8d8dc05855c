#include "run/extension.h"

#include "base/errors.h"
#include "config/keys.h"
#include "config/text.h"
#include "io/text_file.h"
#include "io/toml_document.h"
#include "run/phases/production.h"

#include <fmt/format.h>

#include <filesystem>

namespace hardbody {
namespace {

constexpr std::size_t kLongestStoredConfig = 1 << 22;  ///< bytes

/// Writes what must follow once the checkpoint of the longer run is in its place.
void finish_storing(const RunDirectory& directory, const std::string& config) {
  directory.write(kConfigFile, config);
  directory.reopen();
  std::filesystem::remove(directory.file(kNextConfigFile));
}

}  // namespace

Config extended_config(const Config& config, const Production& production, double time) {
  if (!(production.planned > 0)) {
    throw InputError("production.time is 0: the run has no production to extend; accepted: a new run");
  }
  if (!(time > production.time)) {
    throw InputError(fmt::format("--time is {}, production has lasted {:g} already; accepted: a longer time", time,
                                 production.time));
  }
  if (!config.trajectory.empty() && !config.frames_every) {
    throw InputError(
        fmt::format("output.frames is {}: these frames are spread over all of production, those of a longer one are at "
                    "other times; accepted: a run with output.frames_every or without output.trajectory, or a new run "
                    "with production.time = {}",
                    config.frames, time));
  }
  Config longer = config;
  longer.production_time = time;
  longer.longest_lag = production.longest_lag;
  longer.target_error.reset();
  // The limits of these keys are those of any config.
  (void)read_config(read_toml(resolved_text(longer), "the extended config", {}, Lines::unnamed));
  return longer;
}

void extend_checkpoint(const Config& config, const Config& longer, Checkpoint& checkpoint, const std::string& name) {
  RunState& state = *checkpoint.run;
  state.finished = false;
  state.observables = restored(name, [&] { return extended_observables(config, longer, state); });
  state.production = extended_production(longer, state.production);
  checkpoint.config = resolved_text(longer);
}

void store_extension(const RunDirectory& directory, const Config& longer, const Checkpoint& checkpoint, Saver& saver) {
  const std::string config = resolved_text(longer);
  directory.write(kNextConfigFile, config);
  saver.write(checkpoint);
  finish_storing(directory, config);
}

void complete_extension(const RunDirectory& directory) {
  if (!directory.has(kNextConfigFile)) return;
  directory.check_writable();
  const std::string next = read_file(directory.file(kNextConfigFile), kLongestStoredConfig);
  const Checkpoint checkpoint = read_checkpoint(directory.file(kCheckpointFile));
  if (checkpoint.config == next) {
    finish_storing(directory, next);
  } else {
    std::filesystem::remove(directory.file(kNextConfigFile));
  }
}

}  // namespace hardbody
