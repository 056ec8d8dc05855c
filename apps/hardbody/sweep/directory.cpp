#include "sweep/directory.h"

#include "base/errors.h"
#include "io/text_file.h"
#include "io/toml_document.h"
#include "sweep/changes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <system_error>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestStoredSweep = 1 << 24;  ///< bytes

/// Returns whether there are files of something else, which a sweep must not be mixed with.
bool holds_other_files(const fs::path& directory) {
  if (fs::exists(directory / kSweepFile)) return false;
  return std::any_of(fs::directory_iterator(directory), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) { return entry.path().extension() != ".part"; });
}

std::string stored_text(const SweepFile& sweep, const fs::path& directory) {
  return "# The sweep in this directory.\n" + document_text(moved(sweep.whole, sweep.directory, directory));
}

/// Checks that a sweep is the one that the directory holds, or one with more points. Returns the one it holds.
SweepFile checked_sweep(const fs::path& directory, const SweepFile& sweep) {
  const std::string name = (directory / kSweepFile).string();
  SweepFile held = parse_sweep(read_file(name, kLongestStoredSweep), name, directory);
  check_continues(held, sweep, directory);
  return held;
}

void store(const fs::path& directory, const SweepFile& sweep) {
  write_file(directory / kSweepFile, stored_text(sweep, directory));
  write_file(directory / kBaseFile,
             "# What all points of the sweep have in common; written by hardbody sweep.\n" + document_text(sweep.base));
}

}  // namespace

DirectoryLock take_directory(const fs::path& directory, const SweepFile& sweep) {
  try {
    if (fs::exists(directory) && !fs::is_directory(directory)) {
      throw InputError(fmt::format("{}: is not a directory; accepted: a new or empty directory", directory.string()));
    }
    fs::create_directories(directory);
    DirectoryLock lock(directory);
    if (holds_other_files(directory)) {
      throw InputError(
          fmt::format("{}: holds files, but no sweep; accepted: a new or empty directory, or that of a "
                      "sweep to continue",
                      directory.string()));
    }
    if (fs::exists(directory / kSweepFile)) (void)checked_sweep(directory, sweep);
    store(directory, sweep);
    return lock;
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("{}: cannot be used as directory of a sweep: {}; accepted: a writable directory",
                                 directory.string(), error.code().message()));
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw InputError(error.what());
  }
}

DirectoryLock share_directory(const fs::path& directory, const SweepFile& sweep) {
  const auto plan_first = [&](const char* why) {
    return InputError(
        fmt::format("{}: {}; accepted: the directory of a sweep after hardbody sweep plan with the same "
                    "options",
                    directory.string(), why));
  };
  if (!fs::exists(directory / kSweepFile)) throw plan_first("holds no sweep");
  DirectoryLock lock(directory, Sharing::shared);
  const std::string stored = read_file(directory / kSweepFile, kLongestStoredSweep);
  if (stored == stored_text(sweep, directory)) return lock;
  const SweepFile held = checked_sweep(directory, sweep);
  try {
    check_continues(sweep, held, directory);
  } catch (const InputError&) {
    throw plan_first("holds this sweep with fewer points or replicas");
  }
  return lock;
}

}  // namespace hardbody
