#include "run_directory.h"

#include "errors.h"
#include "text_file.h"

#include <fmt/format.h>

#include <array>
#include <stdexcept>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

constexpr std::array kFiles = {kConfigFile, kSummaryFile,       kCheckpointFile, kEventsFile, kLogFile,
                               kMsdFile,    kRotationalMsdFile, kC2File,         kBlocksFile};

/// The first file of an earlier run; empty if there is none.
std::string trace_of_a_run(const fs::path& directory) {
  for (const char* name : kFiles) {
    if (fs::exists(directory / name)) return name;
  }
  return "";
}

void keep_user_config(const fs::path& directory, const fs::path& user_config) {
  for (const char* name : kFiles) {
    std::error_code ignored;
    if (!fs::equivalent(directory / name, user_config, ignored)) continue;
    throw InputError(fmt::format("{}: --force would delete {}, the config of this run; accepted: another directory",
                                 directory.string(), user_config.string()));
  }
}

/// Removes what a run writes and nothing else, so that a new run never stands beside results of an old one.
void remove_run(const fs::path& directory) {
  for (const char* name : kFiles) fs::remove(directory / name);
  const fs::path failures = directory / kFailuresDirectory;
  if (!fs::is_directory(failures)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(failures)) {
    if (entry.path().extension() == ".json") fs::remove(entry.path());
  }
}

}  // namespace

RunDirectory RunDirectory::create(const fs::path& path, Overwrite overwrite, const fs::path& user_config,
                                  std::string_view config) {
  try {
    if (fs::exists(path) && !fs::is_directory(path)) {
      throw InputError(fmt::format("{}: is not a directory; accepted: a new or empty directory", path.string()));
    }
    const std::string trace = trace_of_a_run(path);
    if (!trace.empty() && overwrite == Overwrite::refused) {
      throw InputError(
          fmt::format("{}: holds a run already ({}); accepted: another directory, or --force to overwrite it",
                      path.string(), trace));
    }
    keep_user_config(path, user_config);
    if (!trace.empty()) remove_run(path);
    RunDirectory directory(path);
    directory.write(kConfigFile, config);
    return directory;
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("{}: cannot be used as run directory: {}; accepted: a writable directory",
                                 path.string(), error.code().message()));
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw InputError(error.what());
  }
}

void RunDirectory::write(const std::string& name, std::string_view content) const {
  const fs::path path = file(name);
  fs::create_directories(path.parent_path());
  write_file(path, content);
}

}  // namespace hardbody
