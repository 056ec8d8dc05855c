#pragma once

/// Extension of a finished run: its checkpoint and its config become those of a longer production that is under way.

#include "base/progress.h"
#include "config/config.h"
#include "io/run_directory.h"
#include "run/checkpoint.h"
#include "run/saver.h"

#include <string>

namespace hardbody {

/// Returns the config of a run that lasts longer, as a user would write it: production.time is `time`, the longest lag
/// that the run has is named, and there is no target error. Throws InputError if the time is not longer, or the run is
/// of a kind that cannot be extended.
Config extended_config(const Config& config, const Production& production, double time);

/// Turns the checkpoint of a finished run into that of an unfinished run with the config `longer`. Throws InputError if
/// the stored observables do not fit; `name`: file of the checkpoint.
void extend_checkpoint(const Config& config, const Config& longer, Checkpoint& checkpoint, const std::string& name);

/// Stores an extended checkpoint and its config in place of those of the finished run, whose summary is removed. A
/// process that ends in the middle leaves either the finished run or the extended one, once complete_extension() has
/// been called.
void store_extension(const RunDirectory& directory, const Config& longer, const Checkpoint& checkpoint, Saver& saver);

/// Completes or discards the extension that a process has begun to store. Does nothing if there is none.
void complete_extension(const RunDirectory& directory);

}  // namespace hardbody
