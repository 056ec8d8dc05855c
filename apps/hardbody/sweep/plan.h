#pragma once

/// Runs that a sweep consists of, and how each is started.

#include "sweep/file.h"
#include "sweep/results.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace hardbody {

/// Returns all runs, the replicas of a point one after the other; those whose config is invalid are failed already.
/// Throws InputError if no point can be run.
std::vector<PointRecord> planned(const SweepFile& sweep);

/// Returns all runs without a look at their configs, which takes long for 10^5 points.
std::vector<PointRecord> listed(const SweepFile& sweep);

/// Reads the config of a run: sets its cost, or marks it as failed.
void judge(const SweepFile& sweep, PointRecord& record);

/// Takes over what the directory of the sweep holds of a run: it is done or failed if it is complete, otherwise it
/// keeps its status.
void take_up(PointRecord& record, const std::filesystem::path& directory);

/// Takes over status and message of a run that state.json shows, if that is there and none of `done`.
void take_up_state(PointRecord& record, const std::filesystem::path& directory);

/// Returns the arguments with which the program, in the directory of the sweep, runs a record or continues it.
std::vector<std::string> arguments_of(const std::vector<PointRecord>& records, std::size_t k,
                                      const std::filesystem::path& directory);

}  // namespace hardbody
