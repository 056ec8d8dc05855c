#pragma once

/// Files of the workflow in the directory of a sweep.

#include "sweep/tasks/bundles.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

inline constexpr const char* kWorkflowDirectory = "workflow";
inline constexpr const char* kWorkflowLogFile = "log.txt";  ///< output of Snakemake

/// Writes the workflow to its directory, for these tasks; files of earlier tasks are removed. `program` is the command
/// that runs a task with the arguments that follow. Throws WriteError.
void write_workflow(const std::filesystem::path& sweep_directory, const std::vector<Bundle>& tasks,
                    const std::vector<std::string>& program);

/// Returns the directory of a Snakemake profile: that of a name, local or slurm, which the workflow has, or a
/// directory. Throws InputError if there is none.
std::filesystem::path workflow_profile(const std::filesystem::path& sweep_directory, const std::string& name);

/// Checks a name, or the directory, of a profile. Throws InputError.
void check_profile(const std::string& name);

/// Tasks of a workflow at some time.
struct TasksAtWork {
  std::vector<int> begun;    ///< ids of tasks of which a process has begun, settled ones too
  std::vector<int> settled;  ///< ids of tasks whose runs are done or have failed for good
};

/// Lists the tasks in the directory of the workflow.
TasksAtWork tasks_at_work(const std::filesystem::path& sweep_directory);

}  // namespace hardbody
