#include "commands/sweep_tasks.h"
#include "base/console.h"
#include "base/errors.h"
#include "base/signals.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "sweep/directory.h"
#include "sweep/file.h"
#include "sweep/plan.h"
#include "sweep/results.h"
#include "sweep/state.h"
#include "sweep/tasks/plan_file.h"
#include "sweep/tasks/task_lock.h"
#include "sweep/workers.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kFailedForGood = 1;
constexpr int kLookForSignals = 100;  ///< milliseconds
/// Words of a WriteError, in the last line of a run that could not write: a full disk, say.
constexpr const char* kNotWritten = "cannot be written";

/// Whether SIGUSR1 has come, which schedulers send before a time limit.
volatile std::sig_atomic_t g_user_signal = 0;

void on_user_signal(int) {
  g_user_signal = 1;
}

void install_task_handlers() {
  install_signal_handlers();
  struct sigaction action = {};
  action.sa_handler = on_user_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGUSR1, &action, nullptr);
}

SweepFile file_of(const SweepTaskArguments& arguments) {
  if (arguments.text) return parse_sweep(*arguments.text, arguments.sweep, "", arguments.overrides, Lines::unnamed);
  return read_sweep(arguments.sweep, arguments.overrides);
}

/// End of the work on a run.
struct TaskEnd {
  int status = 0;       ///< 0, kFailedForGood, kTryAgain, or that of a run that a signal has stopped
  std::string message;  ///< reason for which it is not 0
};

/// Works on the runs of one task, one after the other.
class Task {
 public:
  /// `time_limit`: seconds from now after which the task stops as by SIGUSR1.
  Task(fs::path directory, std::vector<PointRecord> records, int replicas, const std::vector<std::string>& program,
       const std::optional<double>& time_limit)
      : directory_(std::move(directory)),
        state_(directory_, std::move(records), replicas),
        program_(program),
        time_limit_(time_limit) {}

  TaskEnd run(std::size_t k);
  /// Returns the signal that stops the task, or 0.
  int signal() const;
  const std::string& name(std::size_t k) const { return state_.records()[k].directory; }

 private:
  TaskEnd work_on(std::size_t k, const TaskLock& lock);
  std::optional<TaskEnd> origin_of(std::size_t k);
  TaskEnd judged(std::size_t k, const WorkerEnd& end);

  fs::path directory_;
  SweepState state_;
  std::vector<std::string> program_;
  std::optional<double> time_limit_;
  Clock::time_point begun_ = Clock::now();
};

int Task::signal() const {
  if (pending_signal() != 0) return pending_signal();
  const bool late = time_limit_ && std::chrono::duration<double>(Clock::now() - begun_).count() > *time_limit_;
  return g_user_signal != 0 || late ? SIGUSR1 : 0;
}

/// Returns how a run ends that cannot start because of the one before it in its chain; nullopt if it can.
std::optional<TaskEnd> Task::origin_of(std::size_t k) {
  const std::optional<std::size_t>& from = state_.records()[k].starts_from;
  if (!from) return std::nullopt;
  state_.take_up(*from);
  // A run that its own task has given up has no results; neither has one whose predecessor failed.
  PointRecord origin = state_.records()[*from];
  if (origin.status == PointStatus::pending) take_up_state(origin, directory_);
  if (origin.status == PointStatus::done) return std::nullopt;
  if (is_over(origin)) {
    const std::string message = fmt::format("starts from {}, which failed", origin.directory);
    state_.fail_for_good(k, message);
    state_.write_state(k);
    return TaskEnd{kFailedForGood, message};
  }
  return TaskEnd{kTryAgain, fmt::format("starts from {}, which is not done", origin.directory)};
}

/// Returns how a task ends whose run another process writes; nullopt if none does.
std::optional<TaskEnd> used_elsewhere(const fs::path& run) {
  try {
    const DirectoryLock free(run, Sharing::alone, std::chrono::milliseconds(0));
    return std::nullopt;
  } catch (const InputError& error) {
    return TaskEnd{kTryAgain, error.what()};
  }
}

TaskEnd Task::run(std::size_t k) {
  const PointRecord& record = state_.records()[k];
  const fs::path path = directory_ / record.directory;
  try {
    fs::create_directories(path);
    // The lock of a task that was paused is stale, while the run that it has started may still be at work.
    if (!has_task(path)) {
      if (const auto busy = used_elsewhere(path)) return *busy;
    }
    const TaskLock lock(path);
    state_.take_up(k);
    if (record.status == PointStatus::done || record.status == PointStatus::failed) {
      state_.write_state(k);
      return record.status == PointStatus::done ? TaskEnd{} : TaskEnd{kFailedForGood, record.message};
    }
    if (const auto end = origin_of(k)) return *end;
    if (const auto busy = used_elsewhere(path)) return *busy;
    return work_on(k, lock);
  } catch (const TaskLock::Held& held) {
    return {kTryAgain, fmt::format("{} works on it", held.holder)};
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    // The machine has failed, not the run: a full disk, say, or no room for another process.
    return {kTryAgain, error.what()};
  } catch (const std::bad_alloc&) {
    return {kTryAgain, "not enough memory"};
  }
}

TaskEnd Task::work_on(std::size_t k, const TaskLock& lock) {
  Workers workers(program_);
  const std::vector<std::string> arguments = arguments_of(state_.records(), k, directory_);
  state_.settle(k, PointStatus::running, "");
  state_.write_state(k);
  workers.start(static_cast<int>(k), directory_, arguments);
  Clock::time_point touched = Clock::now();
  bool told = false;
  for (;;) {
    const std::vector<WorkerEnd> ends = workers.ended(kLookForSignals);
    if (!ends.empty()) return judged(k, ends.front());
    if (signal() != 0 && !told) workers.signal_all(SIGTERM);
    told = signal() != 0;
    if (Clock::now() - touched < TaskLock::kHeartbeat) continue;
    touched = Clock::now();
    if (lock.touch()) continue;
    // This process was paused, and another task has taken over: nothing more may be written.
    workers.signal_all(SIGKILL);
    return {kTryAgain, "another task has taken over"};
  }
}

TaskEnd Task::judged(std::size_t k, const WorkerEnd& end) {
  // 128 + a signal also of a run that a process of its own has started for it.
  if (end.status > 128) {
    state_.settle(k, PointStatus::stopped, "");
    state_.write_state(k);
    const std::string by_signal = fmt::format("ended by signal {}", end.status - 128);
    if (signal() == 0) return {kTryAgain, by_signal};
    // A start that has not ended has no state.
    const bool begun = fs::exists(directory_ / state_.records()[k].directory / kCheckpointFile);
    const bool stopped = stopped_by_signal(end.status) && !end.killed;
    return {exit_status_of(signal()), !stopped ? by_signal + ", its last checkpoint continues"
                                      : begun  ? "stopped, its state is saved"
                                               : "stopped during its start"};
  }
  state_.end(k, end);
  const PointRecord& record = state_.records()[k];
  const std::string message = record.message;
  const bool of_the_machine = end.status == Workers::kNotStarted || message.find(kNotWritten) != std::string::npos;
  const bool try_again = record.status == PointStatus::failed && of_the_machine;
  if (try_again) state_.settle(k, PointStatus::stopped, message);
  if (record.status == PointStatus::failed) state_.fail_for_good(k, message);
  state_.write_state(k);
  if (record.status == PointStatus::done) return {};
  return {try_again ? kTryAgain : kFailedForGood, message};
}

/// Returns the exit status of a task: that of a signal, else to try again, else of a failure.
int worse(int a, int b) {
  const auto rank = [](int status) {
    return status == 0 ? 0 : status == kFailedForGood ? 1 : status == kTryAgain ? 2 : 3;
  };
  return rank(a) >= rank(b) ? a : b;
}

}  // namespace

int sweep_plan(const SweepTaskArguments& arguments) {
  const SweepFile file = file_of(arguments);
  std::vector<PointRecord> records = planned(file);
  const fs::path directory = directory_for(arguments.out, arguments.sweep);
  const DirectoryLock lock = take_directory(directory, file);
  const Plan plan =
      plan_of(taken_up(directory, std::move(records)), directory, arguments.sweep, arguments.task_time, arguments.jobs);
  write_file(directory / kPlanFile, plan.json);
  console().print(plan.json);
  return 0;
}

int sweep_point(const SweepTaskArguments& arguments) {
  install_task_handlers();
  const SweepFile file = file_of(arguments);
  const fs::path directory = directory_for(arguments.out, arguments.sweep);
  const DirectoryLock lock = share_directory(directory, file);
  std::vector<PointRecord> records = listed(file);
  std::vector<std::size_t> runs;
  for (const std::string& id : arguments.ids) {
    for (const std::size_t k : runs_of(id, records, directory)) runs.push_back(k);
  }
  for (const std::size_t k : runs) {
    judge(file, records[k]);
    if (records[k].starts_from) judge(file, records[*records[k].starts_from]);
  }
  Task task(directory, std::move(records), file.replicas, arguments.program, arguments.time_limit);
  int status = 0;
  for (const std::size_t k : runs) {
    const TaskEnd end = task.run(k);
    status = worse(status, end.status);
    if (end.status != 0) console().say(fmt::format("{}: {}", task.name(k), one_line(end.message)));
    if (task.signal() != 0) return exit_status_of(task.signal());
  }
  return status;
}

int sweep_collect(const SweepTaskArguments& arguments) {
  const SweepFile file = file_of(arguments);
  const fs::path directory = directory_for(arguments.out, arguments.sweep);
  const DirectoryLock lock = share_directory(directory, file);
  SweepState state(directory, taken_up(directory, planned(file)), file.replicas);
  state.write_tables();
  console().print(state.account());
  if (!state.is_over()) return kTryAgain;
  return state.count(PointStatus::failed) > 0 ? kFailedForGood : 0;
}

}  // namespace hardbody
