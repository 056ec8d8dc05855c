#pragma once

/// Lock of a run among the tasks of a cluster, on file systems where flock does not reach other machines.

#include <chrono>
#include <filesystem>
#include <string>
#include <utility>

namespace hardbody {

/// File in the directory of a run that names the task which works on it: host, process and a number of its own. A task
/// creates it (O_EXCL, which file systems of clusters make atomic) and touches it every kHeartbeat.
///
/// A lock is stale if its process is on this host and has ended, or if it was not touched for kStale. Hosts may have
/// the same name: one that was booted since counts as another. Ages are differences of times that the file server gave,
/// so that clocks may differ. A stale lock is renamed, and whoever renamed the stale one may create the next. A process
/// that was only paused finds another number in the file at its next heartbeat: it must end its run at once.
class TaskLock {
 public:
  static constexpr std::chrono::seconds kHeartbeat{15};
  static constexpr std::chrono::seconds kStale{180};

  /// Takes the lock of an existing directory. Throws Held, or WriteError if the file cannot be written.
  explicit TaskLock(const std::filesystem::path& directory);
  ~TaskLock();  ///< removes the file if it is still this lock
  TaskLock(TaskLock&& other) noexcept : file_(std::move(other.file_)), content_(std::exchange(other.content_, "")) {}
  TaskLock& operator=(TaskLock&&) = delete;

  /// Touches the file. Returns false if it is not this lock any more.
  bool touch() const;

  /// Another task holds the lock.
  struct Held {
    std::string holder;  ///< "process 123 on node7"
  };

 private:
  std::filesystem::path file_;
  std::string content_;
};

/// Returns whether a task works on the run in this directory.
bool has_task(const std::filesystem::path& directory);

}  // namespace hardbody
