#include "commands/sweep_tasks.h"
#include "base/console.h"
#include "base/errors.h"
#include "base/find.h"
#include "base/signals.h"
#include "base/version.h"
#include "io/json_values.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "sweep/directory.h"
#include "sweep/file.h"
#include "sweep/plan.h"
#include "sweep/results.h"
#include "sweep/state.h"
#include "sweep/tasks/bundles.h"
#include "sweep/tasks/cost.h"
#include "sweep/tasks/task_lock.h"
#include "sweep/workers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kPlanFile = "plan.json";
constexpr std::size_t kLongestPlan = std::size_t{1} << 28;
constexpr int kTryAgain = 75;  ///< another attempt may succeed (EX_TEMPFAIL)
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

int task_signal() {
  return pending_signal() != 0 ? pending_signal() : g_user_signal != 0 ? SIGUSR1 : 0;
}

SweepFile file_of(const SweepTaskArguments& arguments) {
  return read_sweep(arguments.sweep, arguments.overrides);
}

/// Returns the runs with what the directory holds of them.
std::vector<PointRecord> records_in(const fs::path& directory, std::vector<PointRecord> records) {
  for (PointRecord& record : records) {
    take_up(record, directory);
    if (record.status == PointStatus::pending) take_up_state(record, directory);
    const bool cut = record.status == PointStatus::running && !has_task(directory / record.directory);
    if (cut) record.status = PointStatus::stopped;
  }
  return records;
}

// ---- plan

Json run_json(const PointRecord& record, const std::vector<PointRecord>& records, const std::optional<Cost>& cost) {
  const bool over = record.status == PointStatus::done || record.status == PointStatus::failed;
  return {{"id", record.directory},
          {"point", record.point.name},
          {"replica", record.replica},
          {"seed", record.seed},
          {"status", to_string(record.status)},
          {"starts_from", record.starts_from ? Json(records[*record.starts_from].directory) : Json(nullptr)},
          {"expected_seconds", cost && !over ? number_json(cost->seconds) : Json(nullptr)},
          {"memory_bytes", cost ? number_json(cost->memory) : Json(nullptr)}};
}

Json task_json(const Bundle& bundle, const std::vector<PointRecord>& records) {
  Json ids = Json::array();
  for (const std::size_t k : bundle.runs) ids.push_back(records[k].directory);
  return {{"id", bundle.id},
          {"runs", std::move(ids)},
          {"after", bundle.after ? Json::array({*bundle.after}) : Json::array()},
          {"expected_seconds", bundle.seconds ? number_json(*bundle.seconds) : Json(nullptr)},
          {"memory_bytes", bundle.memory ? number_json(*bundle.memory) : Json(nullptr)}};
}

std::string plan_json(const fs::path& directory, const SweepTaskArguments& arguments,
                      const std::vector<PointRecord>& records) {
  const Costs costs(records);
  std::vector<std::optional<Cost>> expected;
  for (std::size_t k = 0; k < records.size(); ++k) expected.push_back(costs.of(k));
  Json tasks = Json::array();
  for (const Bundle& bundle : bundles_of(records, expected, arguments.task_time)) {
    tasks.push_back(task_json(bundle, records));
  }
  Json runs = Json::array();
  for (std::size_t k = 0; k < records.size(); ++k) runs.push_back(run_json(records[k], records, expected[k]));
  const std::optional<double> error = costs.error();
  const Json json = {{"version", version()},
                     {"sweep", absolute_path(arguments.sweep).string()},
                     {"directory", absolute_path(directory).string()},
                     {"task_seconds", arguments.task_time},
                     {"expected_within_factor", error ? number_json(*error) : Json(nullptr)},
                     {"tasks", std::move(tasks)},
                     {"runs", std::move(runs)}};
  return json.dump(2) + "\n";
}

// ---- point

/// Returns the indices of the runs that an ID names: a run's directory, or the number of a task of the plan.
std::vector<std::size_t> runs_of(const std::string& id, const std::vector<PointRecord>& records,
                                 const fs::path& directory) {
  const auto index_of = [&](const std::string& name) {
    const PointRecord* record = find_by(records, &PointRecord::directory, name);
    return record == nullptr ? std::nullopt : std::optional(static_cast<std::size_t>(record - records.data()));
  };
  if (const auto k = index_of(id)) return {*k};
  const auto refuse = [&](const std::string& accepted) {
    return InputError(
        fmt::format("{}: no run or task of this sweep has this id; accepted: {}", one_line(id, 120), accepted));
  };
  int number = 0;
  const auto [end, error] = std::from_chars(id.data(), id.data() + id.size(), number);
  const fs::path plan = directory / kPlanFile;
  if (error != std::errc() || end != id.data() + id.size()) throw refuse(fmt::format("an id in {}", plan.string()));
  const Json json = Json::parse(read_file(plan, kLongestPlan), nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("tasks")) throw refuse("the plan that hardbody sweep plan writes");
  for (const Json& task : json["tasks"]) {
    if (task.value("id", 0) != number) continue;
    std::vector<std::size_t> runs;
    for (const Json& name : task["runs"]) {
      const auto k = index_of(name.get<std::string>());
      if (!k) throw refuse("a plan of this sweep: hardbody sweep plan writes it again");
      runs.push_back(*k);
    }
    return runs;
  }
  throw refuse(fmt::format("the number of a task in {}", plan.string()));
}

/// End of the work on a run.
struct TaskEnd {
  int status = 0;       ///< 0, kFailedForGood, kTryAgain, or that of a run that a signal has stopped
  std::string message;  ///< reason for which it is not 0
};

/// Works on the runs of one task, one after the other.
class Task {
 public:
  Task(fs::path directory, std::vector<PointRecord> records, int replicas, const std::vector<std::string>& program)
      : directory_(std::move(directory)), state_(directory_, std::move(records), replicas), program_(program) {}

  TaskEnd run(std::size_t k);
  const std::string& name(std::size_t k) const { return state_.records()[k].directory; }

 private:
  TaskEnd work_on(std::size_t k, const TaskLock& lock);
  std::optional<TaskEnd> origin_of(std::size_t k);
  TaskEnd judged(std::size_t k, const WorkerEnd& end);

  fs::path directory_;
  SweepState state_;
  std::vector<std::string> program_;
};

/// Returns how a run ends that cannot start because of the one before it in its chain; nullopt if it can.
std::optional<TaskEnd> Task::origin_of(std::size_t k) {
  const std::optional<std::size_t>& from = state_.records()[k].starts_from;
  if (!from) return std::nullopt;
  state_.take_up(*from);
  const PointRecord& origin = state_.records()[*from];
  if (origin.status == PointStatus::done) return std::nullopt;
  if (origin.status == PointStatus::failed) {
    const std::string message = fmt::format("starts from {}, which failed", origin.directory);
    state_.settle(k, PointStatus::failed, message);
    state_.write_state(k);
    return TaskEnd{kFailedForGood, message};
  }
  return TaskEnd{kTryAgain, fmt::format("starts from {}, which is not done", origin.directory)};
}

TaskEnd Task::run(std::size_t k) {
  const PointRecord& record = state_.records()[k];
  const fs::path path = directory_ / record.directory;
  try {
    fs::create_directories(path);
    const TaskLock lock(path);
    state_.take_up(k);
    if (record.status == PointStatus::done || record.status == PointStatus::failed) {
      state_.write_state(k);
      return record.status == PointStatus::done ? TaskEnd{} : TaskEnd{kFailedForGood, record.message};
    }
    if (const auto end = origin_of(k)) return *end;
    try {
      const DirectoryLock free(path);
    } catch (const InputError& error) {
      return {kTryAgain, error.what()};
    }
    return work_on(k, lock);
  } catch (const TaskLock::Held& held) {
    return {kTryAgain, fmt::format("{} works on it", held.holder)};
  } catch (const WriteError& error) {
    return {kTryAgain, error.what()};
  } catch (const fs::filesystem_error& error) {
    return {kTryAgain, error.what()};
  }
}

TaskEnd Task::work_on(std::size_t k, const TaskLock& lock) {
  using Clock = std::chrono::steady_clock;
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
    if (task_signal() != 0 && !told) workers.signal_all(SIGTERM);
    told = task_signal() != 0;
    if (Clock::now() - touched < TaskLock::kHeartbeat) continue;
    touched = Clock::now();
    if (lock.touch()) continue;
    // This process was paused, and another task has taken over: nothing more may be written.
    workers.signal_all(SIGKILL);
    return {kTryAgain, "another task has taken over"};
  }
}

TaskEnd Task::judged(std::size_t k, const WorkerEnd& end) {
  const int signal = task_signal();
  const bool stopped = stopped_by_signal(end.status);
  if (stopped || end.status > 128) {
    state_.settle(k, PointStatus::stopped, "");
    state_.write_state(k);
    if (stopped && signal != 0) return {exit_status_of(signal), "stopped, its state is saved"};
    return {kTryAgain, fmt::format("ended by signal {}", end.status - 128)};
  }
  state_.end(k, end);
  const PointRecord& record = state_.records()[k];
  const std::string message = record.message;
  const bool try_again = record.status == PointStatus::failed && message.find(kNotWritten) != std::string::npos;
  if (try_again) state_.settle(k, PointStatus::stopped, message);
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
  const std::string text = plan_json(directory, arguments, records_in(directory, std::move(records)));
  write_file(directory / kPlanFile, text);
  console().print(text);
  return 0;
}

int sweep_point(const SweepTaskArguments& arguments) {
  install_task_handlers();
  const SweepFile file = file_of(arguments);
  const fs::path directory = directory_for(arguments.out, arguments.sweep);
  const DirectoryLock lock = share_directory(directory, file);
  std::vector<PointRecord> records = planned(file);
  std::vector<std::size_t> runs;
  for (const std::string& id : arguments.ids) {
    for (const std::size_t k : runs_of(id, records, directory)) runs.push_back(k);
  }
  Task task(directory, std::move(records), file.replicas, arguments.program);
  int status = 0;
  for (const std::size_t k : runs) {
    const TaskEnd end = task.run(k);
    status = worse(status, end.status);
    if (end.status != 0) console().say(fmt::format("{}: {}", task.name(k), one_line(end.message)));
    if (task_signal() != 0) return exit_status_of(task_signal());
  }
  return status;
}

int sweep_collect(const SweepTaskArguments& arguments) {
  const SweepFile file = file_of(arguments);
  const fs::path directory = directory_for(arguments.out, arguments.sweep);
  const DirectoryLock lock = share_directory(directory, file);
  SweepState state(directory, records_in(directory, planned(file)), file.replicas);
  state.write_tables();
  console().print(state.account());
  if (state.count(PointStatus::failed) > 0) return kFailedForGood;
  return state.count(PointStatus::done) == state.records().size() / static_cast<std::size_t>(file.replicas) ? 0
                                                                                                            : kTryAgain;
}

}  // namespace hardbody
