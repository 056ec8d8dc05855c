#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hardbody {

/// Names in a run directory.
inline constexpr const char* kConfigFile = "config.toml";
inline constexpr const char* kSummaryFile = "summary.json";
inline constexpr const char* kCheckpointFile = "checkpoint.bin";
inline constexpr const char* kEventsFile = "events.csv";
inline constexpr const char* kLogFile = "log.txt";
inline constexpr const char* kMsdFile = "observables/msd.csv";
inline constexpr const char* kRotationalMsdFile = "observables/rotational_msd.csv";
inline constexpr const char* kC2File = "observables/c2.csv";
inline constexpr const char* kBlocksFile = "observables/blocks.csv";
inline constexpr const char* kFailuresDirectory = "failures";

enum class Overwrite { refused, allowed };

/// Where a run writes its files.
class RunDirectory {
 public:
  /// Creates the directory (and its parents) and writes `config` into it, before anything else. Where overwriting
  /// is allowed the files of an earlier run are removed, nothing else. Throws InputError if the path cannot be
  /// used, holds a run that may not be overwritten, or has `user_config`, the file that the config was read from,
  /// among the files to be removed; then nothing has been changed.
  static RunDirectory create(const std::filesystem::path& path, Overwrite overwrite,
                             const std::filesystem::path& user_config, std::string_view config);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path file(const std::string& name) const { return path_ / name; }

  /// Writes one file as write_file does; `name` may have a directory in it, which is created.
  void write(const std::string& name, std::string_view content) const;

 private:
  explicit RunDirectory(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;
};

}  // namespace hardbody
