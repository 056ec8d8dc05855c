#pragma once

/// Plan of a sweep as tasks, as hardbody sweep plan stores it.

#include "sweep/results.h"
#include "sweep/tasks/bundles.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

inline constexpr const char* kPlanFile = "plan.json";

/// Takes over what the directory of a sweep holds of its runs. A run is running if a task holds its lock.
std::vector<PointRecord> taken_up(const std::filesystem::path& directory, std::vector<PointRecord> records);

struct Plan {
  std::vector<Bundle> tasks;
  std::string json;  ///< content of plan.json
};

/// Plans the runs that are neither done nor failed. `sweep` is the path of the sweep's file; a task of several runs
/// takes at most `task_seconds`. `jobs`: number of tasks that run at once, if it is known, see bundles_of().
Plan plan_of(const std::vector<PointRecord>& records, const std::filesystem::path& directory, const std::string& sweep,
             double task_seconds, const std::optional<int>& jobs);

/// Returns the indices of the runs that an ID names: a run's directory, or the number of a task of the stored plan.
/// Throws InputError.
std::vector<std::size_t> runs_of(const std::string& id, const std::vector<PointRecord>& records,
                                 const std::filesystem::path& directory);

}  // namespace hardbody
