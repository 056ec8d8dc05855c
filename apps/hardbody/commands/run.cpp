#include "base/errors.h"
#include "base/log.h"
#include "base/signals.h"
#include "base/version.h"
#include "commands/commands.h"
#include "commands/run_to_end.h"
#include "config/keys.h"
#include "config/text.h"
#include "io/run_directory.h"
#include "io/toml_document.h"
#include "start/from_file.h"
#include "sweep/file.h"
#include "sweep/names.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
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

/// Runs the replicas of one state point, which are a sweep without a grid.
int run_replicas(const RunArguments& arguments) {
  if (arguments.force) {
    throw InputError("--force cannot be combined with --replicas; accepted: another directory, or the same replicas");
  }
  SweepArguments replicas;
  replicas.sweep = arguments.config;
  replicas.text = arguments.text;
  replicas.out = arguments.out;
  replicas.program = arguments.program;
  replicas.overrides = arguments.overrides;
  replicas.overrides.push_back(fmt::format("{}={}", kReplicasKey, arguments.replicas));
  const SweepFile file = arguments.text
                             ? parse_sweep(*arguments.text, arguments.config, "", replicas.overrides, Lines::unnamed)
                             : read_sweep(arguments.config, replicas.overrides);
  const Grid& grid = file.grids.front();
  if (!grid.single) {
    throw InputError(fmt::format(
        "{}: [grid] makes this a sweep: hardbody sweep takes it; accepted: the config of one run", grid.where));
  }
  return sweep(replicas);
}

}  // namespace

int run(const RunArguments& arguments) {
  if (arguments.replicas > 1) return run_replicas(arguments);
  std::optional<StartFrame> frame;
  Config config = read_config(arguments, frame);
  install_signal_handlers();
  // Errors of a state to start from are reported before anything is written.
  Continuation at;
  if (config.start_from) at.loaded.origin = take_origin(directory_for(arguments.out, arguments.config), config);
  if (config.start_file) {
    at.loaded.file = start_from_file(config, std::exchange(frame, std::nullopt));
    if (!at.loaded.file->compress) config.packing_fraction = at.loaded.file->packing_fraction;
  }
  const RunDirectory directory = create_directory(arguments, config);
  Log log(directory.file(kLogFile), Log::Begin::afresh);
  log.line(fmt::format("hardbody {}: {} with {}", version(), kConfigFile, arguments.config));
  return run_to_end(config, directory, std::move(at), log);
}

}  // namespace hardbody
