#include "base/console.h"
#include "base/errors.h"
#include "base/progress.h"
#include "base/signals.h"
#include "commands/commands.h"
#include "config/config.h"
#include "config/keys.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "sweep/file.h"
#include "sweep/grid.h"
#include "sweep/results.h"
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
#include <thread>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSweepFile = "sweep.toml";
constexpr const char* kBaseFile = "base.toml";
constexpr std::size_t kLongestStoredSweep = 1 << 24;  ///< bytes

constexpr int kMostJobs = 1024;
constexpr int kSignalLook = 100;  ///< milliseconds between two checks for signals

/// Time to wait for a worker of a killed sweep, which saves its state before it ends: its point is locked until then.
constexpr std::chrono::seconds kPatience{60};

int jobs_for(const SweepArguments& arguments) {
  const int jobs = arguments.jobs.value_or(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  if (jobs >= 1 && jobs <= kMostJobs) return jobs;
  throw InputError(fmt::format("--jobs is {}; accepted: an integer from 1 to {}", jobs, kMostJobs));
}

// ---- The directory

/// Returns whether there are files of something else, which a sweep must not be mixed with.
bool holds_other_files(const fs::path& directory) {
  if (fs::exists(directory / kSweepFile)) return false;
  return std::any_of(fs::directory_iterator(directory), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) { return entry.path().extension() != ".part"; });
}

void check_same_sweep(const fs::path& directory, const SweepFile& sweep) {
  const std::string name = (directory / kSweepFile).string();
  const TomlDocument before = read_toml(read_file(name, kLongestStoredSweep), name, {});
  const std::optional<ChangedKey> changed =
      changed_key(absolute_files(before, directory), absolute_files(sweep.whole, sweep.directory));
  if (!changed) return;
  throw InputError(
      fmt::format("{}: {} is {}, but {} in the sweep that {} holds; accepted: the original sweep, or another "
                  "directory",
                  changed->where, changed->key, changed->now, changed->before, directory.string()));
}

/// Locks the directory and stores the sweep in it. If it is refused nothing has been changed.
DirectoryLock take_directory(const fs::path& directory, const SweepFile& sweep) {
  try {
    if (fs::exists(directory) && !fs::is_directory(directory)) {
      throw InputError(fmt::format("{}: is not a directory; accepted: a new or empty directory", directory.string()));
    }
    fs::create_directories(directory);
    DirectoryLock lock(directory);
    if (holds_other_files(directory)) {
      throw InputError(
          fmt::format("{}: holds files, but no sweep; accepted: a new or empty directory, or that of a "
                      "sweep to continue",
                      directory.string()));
    }
    if (fs::exists(directory / kSweepFile)) {
      check_same_sweep(directory, sweep);
    } else {
      write_file(directory / kSweepFile, "# The sweep in this directory, as it was begun.\n" +
                                             document_text(moved(sweep.whole, sweep.directory, directory)));
    }
    write_file(directory / kBaseFile, "# What all points of the sweep have in common; written by hardbody sweep.\n" +
                                          document_text(sweep.base));
    return lock;
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("{}: cannot be used as directory of a sweep: {}; accepted: a writable directory",
                                 directory.string(), error.code().message()));
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw InputError(error.what());
  }
}

// ---- The points

/// Returns all points; those whose config is invalid are failed already.
std::vector<PointRecord> planned(const SweepFile& sweep) {
  std::vector<PointRecord> records;
  std::string first_refusal;
  std::vector<SweepPoint> points = expand(sweep.grids);
  std::vector<std::optional<std::size_t>> before(points.size());
  if (sweep.chain) before = predecessors(points, *sweep.chain);
  for (std::size_t k = 0; k < points.size(); ++k) {
    SweepPoint& point = points[k];
    PointRecord record;
    record.starts_from = before[k];
    const TomlDocument document = document_of(sweep, point);
    record.point = std::move(point);
    if (const Entry* seed = document.find(kSeedKey)) record.seed = seed->value.integer;
    try {
      (void)read_config(document);
    } catch (const InputError& error) {
      record.status = PointStatus::failed;
      record.message = error.what();
      if (first_refusal.empty()) first_refusal = error.what();
    }
    records.push_back(std::move(record));
  }
  const bool any =
      std::any_of(records.begin(), records.end(), [](const PointRecord& r) { return r.status != PointStatus::failed; });
  // No point can be run: an error of the sweep, not of its points.
  if (!any) throw InputError(first_refusal);
  return records;
}

/// Runs the points of a sweep.
class Sweep {
 public:
  Sweep(fs::path directory, std::vector<PointRecord> records, std::size_t jobs, const std::vector<std::string>& program)
      : directory_(std::move(directory)), records_(std::move(records)), jobs_(jobs), workers_(program) {}

  /// Runs all points and returns the exit status.
  int run();

 private:
  using Clock = std::chrono::steady_clock;

  fs::path path_of(const PointRecord& record) const { return directory_ / record.point.name; }

  void take_up();
  void start_points();
  bool try_to_start(std::size_t k);
  void launch(std::size_t k);
  void end_point(const WorkerEnd& end);
  void stop();
  void settle(PointRecord& record, PointStatus status, const std::string& message);
  void write_state(const PointRecord& record);
  void write_table();
  std::size_t count(PointStatus status) const;
  std::string text() const;
  double fraction_done() const;
  int conclude(int signal);

  fs::path directory_;
  std::vector<PointRecord> records_;
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
  return fmt::format("sweep: {} of {} points done, {} running, {} failed  {}", done, records_.size(),
                     workers_.running(), failed, eta(progress_.seconds(), over, to_do));
}

double Sweep::fraction_done() const {
  return static_cast<double>(count(PointStatus::done) + count(PointStatus::failed)) /
         static_cast<double>(records_.size());
}

/// Writes the table. If a file of the sweep itself cannot be written, completed points are kept; the table is written
/// again after the next point.
void Sweep::write_table() {
  try {
    write_file(directory_ / kSweepTableFile, sweep_csv(records_));
    table_failed_ = false;
  } catch (const std::exception& error) {
    if (!table_failed_) progress_.say(error.what());
    table_failed_ = true;
  }
}

void Sweep::write_state(const PointRecord& record) {
  fs::create_directories(path_of(record));
  write_file(path_of(record) / kPointStateFile, state_json(record));
}

void Sweep::settle(PointRecord& record, PointStatus status, const std::string& message) {
  record.status = status;
  record.message = one_line(message, 1000);
  if (status == PointStatus::failed) {
    progress_.say(fmt::format("{}: failed: {}", path_of(record).string(), record.message));
  }
  try {
    write_state(record);
  } catch (const std::exception& error) {
    progress_.say(error.what());
  }
}

/// Takes over the results of an earlier sweep: completed runs are kept, all others wait.
void Sweep::take_up() {
  for (std::size_t k = 0; k < records_.size(); ++k) {
    PointRecord& record = records_[k];
    if (record.status == PointStatus::failed) {
      settle(record, PointStatus::failed, record.message);
      continue;
    }
    try {
      record.results = finished_results(path_of(record));
    } catch (const std::exception& error) {
      settle(record, PointStatus::failed, error.what());
      continue;
    }
    if (!record.results) {
      waiting_.push_back(k);
    } else if (record.results->sound) {
      settle(record, PointStatus::done, "");
    } else {
      settle(record, PointStatus::failed, "NOT SOUND, see log.txt");
    }
  }
  done_before_ = records_.size() - waiting_.size();
}

void Sweep::launch(std::size_t k) {
  PointRecord& record = records_[k];
  // The process runs in the directory of the sweep, so that messages of a point do not depend on where that is.
  std::vector<std::string> arguments;
  if (fs::exists(path_of(record) / kConfigFile)) {
    arguments = {"resume", record.point.name};
  } else {
    arguments = {"run", kBaseFile, "--out", record.point.name};
    for (const Setting& s : record.point.settings) {
      arguments.emplace_back("--set");
      arguments.push_back(s.assignment());
    }
    if (record.starts_from) {
      arguments.emplace_back("--set");
      arguments.push_back(std::string(kStartFromKey) + "=" + records_[*record.starts_from].point.name);
    }
  }
  record.status = PointStatus::running;
  record.message.clear();
  write_state(record);
  workers_.start(static_cast<int>(k), directory_, arguments);
}

/// Returns false if the point has to wait, for the point that it starts from, or for another process to release its
/// directory.
bool Sweep::try_to_start(std::size_t k) {
  PointRecord& record = records_[k];
  if (record.starts_from) {
    const PointRecord& origin = records_[*record.starts_from];
    if (origin.status == PointStatus::failed) {
      settle(record, PointStatus::failed, fmt::format("starts from {}, which failed", origin.point.name));
      write_table();
      return true;
    }
    if (origin.status != PointStatus::done) return false;
  }
  if (fs::is_directory(path_of(record))) {
    try {
      const DirectoryLock free(path_of(record));
    } catch (const InputError& error) {
      const auto [since, is_new] = locked_.try_emplace(k, Clock::now());
      if (Clock::now() - since->second < kPatience) return false;
      settle(record, PointStatus::failed, error.what());
      return true;
    }
  }
  try {
    launch(k);
  } catch (const std::exception& error) {
    settle(record, PointStatus::failed, error.what());
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
  PointRecord& record = records_[static_cast<std::size_t>(end.id)];
  if (stopped_by_signal(end.status)) {
    settle(record, PointStatus::stopped, "");
    return;
  }
  std::string message = end.last_line;
  try {
    record.results = finished_results(path_of(record));
  } catch (const std::exception& error) {
    message = error.what();
  }
  if (end.status == 0 && record.results && record.results->sound) {
    settle(record, PointStatus::done, "");
  } else {
    if (message.empty()) message = fmt::format("ended with exit status {}", end.status);
    settle(record, PointStatus::failed, message);
  }
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
  const std::size_t failed = count(PointStatus::failed);
  const std::size_t done = count(PointStatus::done);
  console().print(fmt::format(
      "{}: {} points: {} done, {} failed{}\n", directory_.string(), records_.size(), done, failed,
      done + failed < records_.size() ? fmt::format(", {} to do", records_.size() - done - failed) : std::string()));
  for (const PointRecord& record : records_) {
    if (record.status != PointStatus::failed) continue;
    console().print(fmt::format("failed: {}: {}\n", record.point.name, record.message));
  }
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
  const std::size_t jobs = static_cast<std::size_t>(jobs_for(arguments));
  const SweepFile file =
      arguments.text ? parse_sweep(*arguments.text, arguments.sweep, "", Lines::unnamed) : read_sweep(arguments.sweep);
  std::vector<PointRecord> records = planned(file);
  const fs::path directory = directory_for(arguments.out, arguments.sweep);
  const DirectoryLock lock = take_directory(directory, file);
  return Sweep(directory, std::move(records), jobs, arguments.program).run();
}

}  // namespace hardbody
