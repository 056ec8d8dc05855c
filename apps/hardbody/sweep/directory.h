#pragma once

/// Directory of a sweep: what it holds, and which processes use it.

#include "io/run_directory.h"
#include "sweep/file.h"

#include <filesystem>

namespace hardbody {

inline constexpr const char* kSweepFile = "sweep.toml";  ///< sweep of the directory, with overrides
inline constexpr const char* kBaseFile = "base.toml";    ///< config that all points have in common

/// Locks the directory of a sweep for this process alone and stores the sweep in it. Throws InputError if the directory
/// is in use, holds other files, or another sweep than this one with fewer points; then nothing has been changed.
DirectoryLock take_directory(const std::filesystem::path& directory, const SweepFile& sweep);

/// Locks the directory of a sweep that is stored in it, together with other processes that do the same. Throws
/// InputError if it does not hold exactly this sweep, or another process uses it alone.
DirectoryLock share_directory(const std::filesystem::path& directory, const SweepFile& sweep);

}  // namespace hardbody
