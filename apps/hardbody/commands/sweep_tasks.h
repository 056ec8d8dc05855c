#pragma once

/// Parts of the subcommand sweep that run a sweep as tasks of a cluster: its plan, one task, the table.

#include <optional>
#include <string>
#include <vector>

namespace hardbody {

/// Exit status of work that another attempt may complete (EX_TEMPFAIL).
inline constexpr int kTryAgain = 75;

struct SweepTaskArguments {
  std::string sweep;                   ///< path of the TOML file
  std::optional<std::string> text;     ///< sweep as TOML, without a file; `sweep` is then its name in messages
  std::vector<std::string> ids;        ///< names of runs, or numbers of tasks of the plan
  std::optional<std::string> out;      ///< directory of the sweep; by default out/<stem of the file>
  double task_time = 600;              ///< wished length of a task of several runs, in seconds
  std::optional<int> jobs;             ///< number of tasks that run at once, if it is known
  std::optional<double> time_limit;    ///< seconds after which a task saves its state and ends
  std::vector<std::string> overrides;  ///< section.key=value, or grid.section.key=list
  std::vector<std::string> program;    ///< command that the subcommands of a run are appended to; empty: this program
};

/// Prints the plan of a sweep as JSON and stores it, and the sweep, in the directory.
int sweep_plan(const SweepTaskArguments& arguments);
/// Runs what the ids name, or continues it. Returns 0 if all is done, 1 if something has failed for good, 75 if another
/// attempt may succeed, 128 + signal if a signal has stopped it.
int sweep_point(const SweepTaskArguments& arguments);
/// Makes the tables of what is there. Returns 0 if all runs are done, 75 if some are to do, else 1: some have failed.
int sweep_collect(const SweepTaskArguments& arguments);

}  // namespace hardbody
