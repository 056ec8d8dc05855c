#include "base/console.h"
#include "base/errors.h"
#include "base/progress.h"
#include "base/signals.h"
#include "commands/commands.h"
#include "commands/sweep_tasks.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "sweep/directory.h"
#include "sweep/file.h"
#include "sweep/plan.h"
#include "sweep/state.h"
#include "sweep/tasks/plan_file.h"
#include "sweep/tasks/task_lock.h"
#include "sweep/workers.h"
#include "sweep/workflow/engine.h"
#include "sweep/workflow/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kLook = 200;  ///< milliseconds between two checks for signals
/// Time for which runs of a workflow that was stopped are waited for: Slurm kills jobs 30 seconds after SIGTERM.
constexpr std::chrono::seconds kStopPatience{60};
/// Time for which Snakemake may go on once all tasks are settled: it never learns how jobs have ended where a profile
/// has it ask Slurm for accounts that are not kept.
constexpr std::chrono::seconds kEnginePatience{120};
/// Failed attempts, of each task and of all, after which the sweep ends if no task has begun: something is wrong for
/// all.
constexpr std::size_t kVainAttemptsOfATask = 3;
constexpr std::size_t kVainAttempts = 30;
constexpr int kMostClusterJobs = 100'000;

/// Returns the number of tasks that run at once, where it is known before they are planned: on this machine. Throws
/// InputError for a number of jobs that is none.
std::optional<int> known_jobs(const SweepArguments& arguments) {
  if (arguments.on == "local") return jobs_on_this_machine(arguments.jobs);
  if (!arguments.jobs || (*arguments.jobs >= 1 && *arguments.jobs <= kMostClusterJobs)) return std::nullopt;
  throw InputError(fmt::format("--jobs is {}; accepted: an integer from 1 to {}", *arguments.jobs, kMostClusterJobs));
}

/// A sweep whose tasks Snakemake runs.
class WorkflowSweep {
 public:
  explicit WorkflowSweep(const SweepArguments& arguments)
      : arguments_(arguments),
        file_(arguments.text ? parse_sweep(*arguments.text, arguments.sweep, "", arguments.overrides, Lines::unnamed)
                             : read_sweep(arguments.sweep, arguments.overrides)),
        directory_(directory_for(arguments.out, arguments.sweep)) {}

  /// Runs what is to do and returns the exit status.
  int run();

 private:
  DirectoryLock prepare();
  int run_tasks();
  std::string text(const TasksAtWork& now) const;
  double done(const TasksAtWork& now) const;
  void wait_for_tasks() const;
  int conclude(int signal, const std::string& failure);

  const SweepArguments& arguments_;
  SweepFile file_;
  fs::path directory_;
  std::size_t runs_ = 0;         ///< runs of the sweep
  std::size_t done_before_ = 0;  ///< runs that were settled before
  std::vector<Bundle> tasks_;    ///< tasks by id, from 1
  Progress progress_;
};

/// Plans the tasks and writes the workflow; other sweeps are kept out of the directory meanwhile.
DirectoryLock WorkflowSweep::prepare() {
  std::vector<PointRecord> records = planned(file_);
  const DirectoryLock alone = take_directory(directory_, file_);
  fs::create_directories(directory_ / kWorkflowDirectory);
  DirectoryLock workflow(directory_ / kWorkflowDirectory);
  records = taken_up(directory_, std::move(records));
  Plan plan =
      plan_of(records, directory_, (directory_ / kSweepFile).string(), arguments_.task_time, known_jobs(arguments_));
  write_file(directory_ / kPlanFile, plan.json);
  std::vector<std::string> program = arguments_.program;
  if (program.empty()) program = {fs::read_symlink("/proc/self/exe").string()};
  write_workflow(directory_, plan.tasks, program);
  tasks_ = std::move(plan.tasks);
  runs_ = records.size();
  done_before_ = runs_;
  for (const Bundle& task : tasks_) done_before_ -= task.runs.size();
  return workflow;
}

std::string WorkflowSweep::text(const TasksAtWork& now) const {
  std::size_t runs = done_before_;
  for (const int id : now.settled) runs += tasks_.at(static_cast<std::size_t>(id - 1)).runs.size();
  return fmt::format("sweep on {}: {} of {} runs done, {} of {} tasks, {} begun  {}", *arguments_.on, runs, runs_,
                     now.settled.size(), tasks_.size(), std::max(now.begun.size(), now.settled.size()),
                     eta(progress_.seconds(), done(now), 1));
}

/// Returns the fraction of the work that is done, by expected times where all are known.
double WorkflowSweep::done(const TasksAtWork& now) const {
  const bool known = std::all_of(tasks_.begin(), tasks_.end(), [](const Bundle& t) { return t.seconds.has_value(); });
  const auto cost = [&](const Bundle& t) { return known ? *t.seconds : static_cast<double>(t.runs.size()); };
  double all = 0;
  double settled = 0;
  for (const Bundle& task : tasks_) all += cost(task);
  for (const int id : now.settled) settled += cost(tasks_.at(static_cast<std::size_t>(id - 1)));
  return all > 0 ? settled / all : 0;
}

/// Waits until no task of this workflow holds the lock of a run, so that all states are saved when the command ends.
void WorkflowSweep::wait_for_tasks() const {
  const auto end = Clock::now() + kStopPatience;
  const std::vector<PointRecord> records = planned(file_);
  const TasksAtWork now = tasks_at_work(directory_);
  for (const int id : now.begun) {
    for (const std::size_t k : tasks_.at(static_cast<std::size_t>(id - 1)).runs) {
      while (has_task(directory_ / records[k].directory) && Clock::now() < end) {
        std::this_thread::sleep_for(std::chrono::milliseconds(kLook));
      }
    }
  }
}

int WorkflowSweep::conclude(int signal, const std::string& failure) {
  SweepState state(directory_, taken_up(directory_, planned(file_)), file_.replicas);
  state.write_tables();
  progress_.clear();
  console().print(state.account());
  if (signal != 0) {
    progress_.say(
        fmt::format("{}: stopped by {}: the same command continues", directory_.string(), signal_name(signal)));
    return exit_status_of(signal);
  }
  if (!state.is_over()) {
    const std::string log = (directory_ / kWorkflowDirectory / kWorkflowLogFile).string();
    const bool none = tasks_at_work(directory_).begun.empty();
    progress_.say(
        fmt::format("{}: {}; see {}{}", directory_.string(),
                    none ? fmt::format("no task has begun: {}", failure.empty() ? "no reason is known" : failure)
                         : "some tasks failed at every attempt: the same command continues",
                    log,
                    none ? fmt::format("; machines that run tasks must see {} and the program under the same names",
                                       absolute_path(directory_).string())
                         : ""));
    return none ? 1 : kTryAgain;
  }
  return state.count(PointStatus::failed) > 0 ? 1 : 0;
}

int WorkflowSweep::run_tasks() {
  progress_.begin();
  Engine engine(directory_, *arguments_.on, arguments_.jobs);
  std::optional<Clock::time_point> settled;  // when the last task was found to be
  bool in_vain = false;
  bool told = false;
  for (;;) {
    if (const std::optional<int> status = engine.ended(kLook)) {
      if (pending_signal() != 0) wait_for_tasks();
      return conclude(pending_signal(), *status == 0 ? "" : engine.failure());
    }
    const bool stops = pending_signal() != 0 || in_vain || (settled && Clock::now() - *settled > kEnginePatience);
    if (stops && !told) engine.stop();
    told = told || stops;
    if (!progress_.due()) continue;
    const TasksAtWork now = tasks_at_work(directory_);
    if (now.settled.size() == tasks_.size() && !settled) settled = Clock::now();
    in_vain = now.begun.empty() && static_cast<std::size_t>(engine.failed_attempts()) >=
                                       std::min(kVainAttempts, kVainAttemptsOfATask * tasks_.size());
    progress_.show(text(now), done(now));
  }
}

int WorkflowSweep::run() {
  const DirectoryLock workflow = prepare();
  // Tasks share the directory; a local sweep and other plans are refused until this one has ended.
  const DirectoryLock shared = share_directory(directory_, file_);
  if (tasks_.empty()) return conclude(0, "");
  return run_tasks();
}

}  // namespace

int sweep_on(const SweepArguments& arguments) {
  install_signal_handlers();
  (void)known_jobs(arguments);
  check_profile(*arguments.on);
  check_engine(*arguments.on);
  return WorkflowSweep(arguments).run();
}

}  // namespace hardbody
