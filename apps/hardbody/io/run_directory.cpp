#include "io/run_directory.h"

#include "base/errors.h"
#include "io/text_file.h"
#include "registry/curves.h"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

/// Files that a run writes into its directory.
std::vector<std::string> files_of_run() {
  std::vector<std::string> files = {kConfigFile, kSummaryFile, kCheckpointFile, kEventsFile,
                                    kGsdFile,    kLammpsFile,  kVtkFile,        kLogFile};
  for (const CurveFile& file : curve_files()) files.push_back(file.path());
  for (const char* name : {kReportFile, kNextConfigFile}) files.emplace_back(name);
  return files;
}

/// Returns the first file of an earlier run; empty if there is none.
std::string trace_of_a_run(const fs::path& directory) {
  for (const std::string& name : files_of_run()) {
    if (fs::exists(directory / name)) return name;
  }
  return "";
}

InputError holds_a_run(const fs::path& directory, const std::string& trace) {
  return InputError(
      fmt::format("{}: already holds a run ({}); accepted: another directory, hardbody resume to continue it, or "
                  "--force to overwrite it",
                  directory.string(), trace));
}

InputError unusable(const fs::path& directory, const std::string& why) {
  return InputError(
      fmt::format("{}: cannot be used as run directory: {}; accepted: a writable directory", directory.string(), why));
}

void keep_inputs(const fs::path& directory, const std::vector<fs::path>& inputs) {
  for (const std::string& name : files_of_run()) {
    for (const fs::path& input : inputs) {
      std::error_code ignored;
      if (!fs::equivalent(directory / name, input, ignored)) continue;
      throw InputError(
          fmt::format("{}: --force would delete {}, which is an input of this run; accepted: another directory",
                      directory.string(), input.string()));
    }
  }
}

/// Removes the files that a run writes and nothing else, so that a new run is never mixed with results of an old one.
void remove_run(const fs::path& directory) {
  for (const std::string& name : files_of_run()) fs::remove(directory / name);
  const fs::path analysis = directory / kAnalysisDirectory;
  for (const CurveFile& file : curve_files()) {
    if (file.in_frames) fs::remove(analysis / (file.name + ".csv"));
  }
  for (const char* name : {kOrderFile, kAnalysisFile}) fs::remove(analysis / name);
  if (fs::is_directory(analysis) && fs::is_empty(analysis)) fs::remove(analysis);
  const fs::path failures = directory / kFailuresDirectory;
  if (!fs::is_directory(failures)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(failures)) {
    if (entry.path().extension() == ".json") fs::remove(entry.path());
  }
}

/// Locks as flock() does, as soon as no other process holds the lock; returns false if one still does after `patience`.
bool lock_soon(int descriptor, int kind, std::chrono::milliseconds patience) {
  constexpr std::chrono::milliseconds kPause(20);
  for (; ::flock(descriptor, kind | LOCK_NB) != 0; patience -= kPause) {
    if (errno != EWOULDBLOCK || patience <= kPause) return false;
    std::this_thread::sleep_for(kPause);
  }
  return true;
}

}  // namespace

fs::path directory_for(const std::optional<std::string>& out, const fs::path& config) {
  if (out && out->empty()) throw InputError("--out is empty; accepted: the name of a directory");
  return out ? fs::path(*out) : "out" / config.stem();
}

DirectoryLock::DirectoryLock(const fs::path& directory, Sharing sharing, std::chrono::milliseconds patience)
    : descriptor_(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  const int kind = sharing == Sharing::alone ? LOCK_EX : LOCK_SH;
  if (descriptor_ >= 0 && lock_soon(descriptor_, kind, patience)) return;
  const int error = errno;
  if (descriptor_ >= 0) ::close(descriptor_);
  if (error != EWOULDBLOCK) throw unusable(directory, fmt::format("it cannot be locked: {}", std::strerror(error)));
  throw InputError(fmt::format("{}: another hardbody process is using it; accepted: another directory, or wait",
                               directory.string()));
}

DirectoryLock::~DirectoryLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

RunDirectory RunDirectory::create(const fs::path& path, Overwrite overwrite, const std::vector<fs::path>& inputs,
                                  std::string_view config) {
  try {
    if (fs::exists(path) && !fs::is_directory(path)) {
      throw InputError(
          fmt::format("{}: is not a directory; accepted: a new directory, or one without a run", path.string()));
    }
    std::string trace = trace_of_a_run(path);
    if (!trace.empty() && overwrite == Overwrite::refused) throw holds_a_run(path, trace);
    keep_inputs(path, inputs);
    fs::create_directories(path);
    RunDirectory directory(path);
    // Checked again, now that no other process can begin a run.
    if (trace.empty()) trace = trace_of_a_run(path);
    if (!trace.empty() && overwrite == Overwrite::refused) throw holds_a_run(path, trace);
    if (!trace.empty()) remove_run(path);
    directory.write(kConfigFile, config);
    return directory;
  } catch (const fs::filesystem_error& error) {
    throw unusable(path, error.code().message());
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw InputError(error.what());
  }
}

void check_run_directory(const fs::path& directory, const char* kinds) {
  if (!fs::is_directory(directory)) {
    throw InputError(fmt::format("{}: is {}; accepted: the directory of a run", directory.string(),
                                 fs::exists(directory) ? "not a directory" : "not there"));
  }
  if (fs::exists(directory / kConfigFile)) return;
  throw InputError(fmt::format("{}: holds no run: {} is missing; accepted: the directory of {}", directory.string(),
                               kConfigFile, kinds));
}

void check_length(const fs::path& path, std::optional<std::uint64_t> at_checkpoint) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (!error && at_checkpoint && bytes >= *at_checkpoint) return;
  throw InputError(fmt::format("{}: has {} bytes, {} when the checkpoint was written; accepted: the file of the run",
                               path.string(), error ? 0 : bytes, at_checkpoint.value_or(0)));
}

RunDirectory RunDirectory::open(const fs::path& path) {
  check_run_directory(path);
  return RunDirectory(path);
}

void RunDirectory::check_writable() const {
  if (::access(path_.c_str(), W_OK | X_OK) != 0) throw unusable(path_, std::strerror(errno));
}

void RunDirectory::write(const std::string& name, std::string_view content) const {
  write(name, [content](const Sink& sink) { sink(content); });
}

void RunDirectory::write(const std::string& name, const std::function<void(const Sink&)>& make) const {
  const fs::path path = file(name);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) throw WriteError(path.parent_path(), error.value());
  write_file(path, make);
}

}  // namespace hardbody
