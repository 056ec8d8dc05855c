#include "base/console.h"
#include "base/errors.h"
#include "base/progress.h"
#include "base/signals.h"
#include "commands/commands.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "sweep/directory.h"
#include "sweep/file.h"
#include "sweep/plan.h"
#include "sweep/results.h"
#include "sweep/state.h"
#include "sweep/workers.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <deque>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

constexpr int kSignalLook = 100;  ///< milliseconds between two checks for signals

/// Time to wait for a worker of a killed sweep, which saves its state before it ends: its point is locked until then.
constexpr std::chrono::seconds kPatience{60};

/// Runs the points of a sweep.
class Sweep {
 public:
  Sweep(fs::path directory, std::vector<PointRecord> records, int replicas, std::size_t jobs,
        const std::vector<std::string>& program)
      : directory_(std::move(directory)),
        state_(directory_, std::move(records), replicas),
        records_(state_.records()),
        jobs_(jobs),
        workers_(program) {}

  /// Runs all points and returns the exit status.
  int run();

 private:
  using Clock = std::chrono::steady_clock;

  fs::path path_of(const PointRecord& record) const { return directory_ / record.directory; }

  void take_up();
  void start_points();
  bool try_to_start(std::size_t k);
  void launch(std::size_t k);
  void end_point(const WorkerEnd& end);
  void stop();
  void settle(std::size_t k, PointStatus status, const std::string& message);
  void write_table();
  std::size_t count(PointStatus status) const;
  std::string text() const;
  double fraction_done() const;
  int conclude(int signal);

  fs::path directory_;
  SweepState state_;
  const std::vector<PointRecord>& records_;
  std::size_t jobs_;
  std::deque<std::size_t> waiting_;
  /// Points locked by another process, with the time at which this was noticed.
  std::map<std::size_t, Clock::time_point> locked_;
  std::size_t done_before_ = 0;
  bool table_failed_ = false;
  Workers workers_;
  Progress progress_;
};

std::size_t Sweep::count(PointStatus status) const {
  return static_cast<std::size_t>(
      std::count_if(records_.begin(), records_.end(), [&](const PointRecord& r) { return r.status == status; }));
}

std::string Sweep::text() const {
  const std::size_t done = count(PointStatus::done);
  const std::size_t failed = count(PointStatus::failed);
  const auto over = static_cast<double>(done + failed - done_before_);
  const auto to_do = static_cast<double>(records_.size() - done_before_);
  return fmt::format("sweep: {} of {} {} done, {} running, {} failed  {}", done, records_.size(),
                     state_.replicas() > 1 ? "runs" : "points", workers_.running(), failed,
                     eta(progress_.seconds(), over, to_do));
}

double Sweep::fraction_done() const {
  return static_cast<double>(count(PointStatus::done) + count(PointStatus::failed)) /
         static_cast<double>(records_.size());
}

/// Writes the table. If a file of the sweep itself cannot be written, completed points are kept; the table is written
/// again after the next point.
void Sweep::write_table() {
  try {
    state_.write_tables();
    table_failed_ = false;
  } catch (const std::exception& error) {
    if (!table_failed_) progress_.say(error.what());
    table_failed_ = true;
  }
}

void Sweep::settle(std::size_t k, PointStatus status, const std::string& message) {
  state_.settle(k, status, one_line(message, 1000));
  const PointRecord& record = records_[k];
  if (status == PointStatus::failed) {
    progress_.say(fmt::format("{}: failed: {}", path_of(record).string(), record.message));
  }
  try {
    state_.write_state(k);
  } catch (const std::exception& error) {
    progress_.say(error.what());
  }
}

/// Takes over the results of an earlier sweep: completed runs are kept, all others wait.
void Sweep::take_up() {
  for (std::size_t k = 0; k < records_.size(); ++k) {
    state_.take_up(k);
    const PointRecord& record = records_[k];
    if (record.status == PointStatus::pending) {
      waiting_.push_back(k);
    } else {
      settle(k, record.status, record.message);
    }
  }
  done_before_ = records_.size() - waiting_.size();
}

void Sweep::launch(std::size_t k) {
  // The process runs in the directory of the sweep, so that messages of a point do not depend on where that is.
  const std::vector<std::string> arguments = arguments_of(records_, k, directory_);
  state_.settle(k, PointStatus::running, "");
  state_.write_state(k);
  workers_.start(static_cast<int>(k), directory_, arguments);
}

/// Returns false if the point has to wait, for the point that it starts from, or for another process to release its
/// directory.
bool Sweep::try_to_start(std::size_t k) {
  const PointRecord& record = records_[k];
  if (record.starts_from) {
    const PointRecord& origin = records_[*record.starts_from];
    if (origin.status == PointStatus::failed) {
      settle(k, PointStatus::failed, fmt::format("starts from {}, which failed", origin.directory));
      write_table();
      return true;
    }
    if (origin.status != PointStatus::done) return false;
  }
  if (fs::is_directory(path_of(record))) {
    try {
      const DirectoryLock free(path_of(record), Sharing::alone, std::chrono::milliseconds(0));
    } catch (const InputError& error) {
      const auto [since, is_new] = locked_.try_emplace(k, Clock::now());
      if (Clock::now() - since->second < kPatience) return false;
      settle(k, PointStatus::failed, error.what());
      return true;
    }
  }
  try {
    launch(k);
  } catch (const std::exception& error) {
    settle(k, PointStatus::failed, error.what());
    write_table();
  }
  return true;
}

void Sweep::start_points() {
  std::deque<std::size_t> later;
  while (!waiting_.empty() && workers_.running() < jobs_) {
    const std::size_t k = waiting_.front();
    waiting_.pop_front();
    if (!try_to_start(k)) later.push_back(k);
  }
  waiting_.insert(waiting_.begin(), later.begin(), later.end());
}

void Sweep::end_point(const WorkerEnd& end) {
  const auto k = static_cast<std::size_t>(end.id);
  if (stopped_by_signal(end.status)) {
    settle(k, PointStatus::stopped, "");
    return;
  }
  state_.end(k, end);
  settle(k, records_[k].status, records_[k].message);
  write_table();
}

/// Stops the workers, which save their states.
void Sweep::stop() {
  workers_.signal_all(pending_signal() == kCallerStops ? SIGTERM : pending_signal());
  while (workers_.running() > 0) {
    for (const WorkerEnd& end : workers_.ended(kSignalLook)) end_point(end);
  }
}

int Sweep::conclude(int signal) {
  write_table();
  progress_.clear();
  console().print(state_.account());
  const std::size_t failed = state_.count(PointStatus::failed);
  if (signal != 0) {
    progress_.say(
        fmt::format("{}: stopped by {}: the same command continues", directory_.string(), signal_name(signal)));
    return exit_status_of(signal);
  }
  return failed > 0 || table_failed_ ? 1 : 0;
}

int Sweep::run() {
  progress_.begin();
  take_up();
  write_table();
  while (pending_signal() == 0 && (!waiting_.empty() || workers_.running() > 0)) {
    start_points();
    for (const WorkerEnd& end : workers_.ended(kSignalLook)) end_point(end);
    if (progress_.due()) progress_.show(text(), fraction_done());
  }
  const int signal = pending_signal();
  if (signal != 0) stop();
  return conclude(signal);
}

}  // namespace

int sweep(const SweepArguments& arguments) {
  install_signal_handlers();
  const std::size_t jobs = static_cast<std::size_t>(jobs_on_this_machine(arguments.jobs));
  const SweepFile file = arguments.text
                             ? parse_sweep(*arguments.text, arguments.sweep, "", arguments.overrides, Lines::unnamed)
                             : read_sweep(arguments.sweep, arguments.overrides);
  std::vector<PointRecord> records = planned(file);
  const fs::path directory = directory_for(arguments.out, arguments.sweep);
  const DirectoryLock lock = take_directory(directory, file);
  return Sweep(directory, std::move(records), file.replicas, jobs, arguments.program).run();
}

}  // namespace hardbody
