#pragma once

#include "io/text_file.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hardbody {

/// Names of files in a run directory.
inline constexpr const char* kConfigFile = "config.toml";
inline constexpr const char* kNextConfigFile = "config.next.toml";  ///< config of an extension that is being stored
inline constexpr const char* kSummaryFile = "summary.json";
inline constexpr std::size_t kLongestSummary = 16 << 20;  ///< limit in bytes
inline constexpr const char* kCheckpointFile = "checkpoint.bin";
inline constexpr const char* kEventsFile = "events.csv";
inline constexpr const char* kGsdFile = "trajectory.gsd";
inline constexpr const char* kLammpsFile = "trajectory.lammpstrj";
inline constexpr const char* kVtkFile = "trajectory.vtp";
inline constexpr const char* kLogFile = "log.txt";
inline constexpr const char* kSweepTableFile = "sweep.csv";
inline constexpr const char* kPointStateFile = "state.json";
inline constexpr const char* kReportFile = "report.html";
// Output of hardbody analyze for the run's trajectory, unless another directory is given.
inline constexpr const char* kAnalysisDirectory = "analysis";
inline constexpr const char* kAnalysisFile = "analysis.json";
inline constexpr const char* kOrderFile = "order.csv";
inline constexpr const char* kFailuresDirectory = "failures";

/// Returns the directory that a command writes to: `out`, or out/<stem of the config>. Throws InputError if `out` is
/// empty.
std::filesystem::path directory_for(const std::optional<std::string>& out, const std::filesystem::path& config);

/// Checks that the directory of a run is there, with its config; `kinds` ends the message. Throws InputError.
void check_run_directory(const std::filesystem::path& directory, const char* kinds = "a run");

/// Checks that a file of a run is at least as long as its checkpoint says; nullopt: it says nothing. Throws InputError.
void check_length(const std::filesystem::path& path, std::optional<std::uint64_t> at_checkpoint);

enum class Overwrite { refused, allowed };

/// Whether a lock excludes all other processes, or those only that want the directory alone.
enum class Sharing { alone, shared };

/// Lock of a directory against other processes, by flock on the directory itself: no file is left behind, and the
/// system releases the lock when the process ends, in whatever way.
class DirectoryLock {
 public:
  /// Locks the directory. Throws InputError if the directory cannot be locked, or another process still holds the lock
  /// after `patience`: one that was killed on a busy machine, or a child that it was about to start, holds it for some
  /// milliseconds yet.
  explicit DirectoryLock(const std::filesystem::path& directory, Sharing sharing = Sharing::alone,
                         std::chrono::milliseconds patience = std::chrono::seconds(1));
  ~DirectoryLock();
  DirectoryLock(DirectoryLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  DirectoryLock& operator=(DirectoryLock&&) = delete;

 private:
  int descriptor_;
};

/// Directory that a run writes its files to, locked against other processes during the object's lifetime.
class RunDirectory {
 public:
  /// Creates the directory (and its parents) and writes `config` into it, before anything else. If overwriting is
  /// allowed the files of an earlier run are removed, nothing else. Throws InputError if the path cannot be used, holds
  /// a run that may not be overwritten, or if one of `inputs`, the files that the run is made from, is among those to
  /// be removed; then nothing has been changed.
  static RunDirectory create(const std::filesystem::path& path, Overwrite overwrite,
                             const std::vector<std::filesystem::path>& inputs, std::string_view config);

  /// Opens the directory of an existing run. Changes nothing. Throws InputError if it is not a run directory or is in
  /// use.
  static RunDirectory open(const std::filesystem::path& path);

  /// Throws InputError if the directory cannot be written to.
  void check_writable() const;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path file(const std::string& name) const { return path_ / name; }

  /// Writes one file, see write_file; `name` may contain a directory, which is created. Throws WriteError.
  void write(const std::string& name, std::string_view content) const;
  /// Writes one file whose content is produced in pieces.
  void write(const std::string& name, const std::function<void(const Sink&)>& make) const;

  /// Returns whether this file exists.
  bool has(const std::string& name) const { return std::filesystem::exists(file(name)); }

  /// Removes the summary, which marks a run as complete, before the run is continued.
  void reopen() const { std::filesystem::remove(file(kSummaryFile)); }

 private:
  explicit RunDirectory(std::filesystem::path path) : path_(std::move(path)), lock_(path_) {}

  std::filesystem::path path_;
  DirectoryLock lock_;
};

}  // namespace hardbody
