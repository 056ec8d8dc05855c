#pragma once

/// Other processes of this program, a few at a time.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace hardbody {

/// Returns the number of processes that run at once on this machine: that of `--jobs`, by default one for each
/// processor. Throws InputError.
int jobs_on_this_machine(const std::optional<int>& jobs);

/// End of a process.
struct WorkerEnd {
  int id = 0;             ///< id given to start()
  int status = 0;         ///< exit status, or 128 + the signal that ended it
  bool killed = false;    ///< true if a signal ended it, before it could save its state
  std::string last_line;  ///< last line on stderr, which gives the reason of a failure
};

/// Starts the program with arguments, several times, and waits for its processes. Their stdout is discarded, the last
/// line of stderr is kept. Each process is in a group of its own, so that Ctrl-C reaches it only through `signal_all`,
/// and it gets SIGTERM if this process dies.
class Workers {
 public:
  /// Exit status of a process that the system could create, but not give the program.
  static constexpr int kNotStarted = 127;

  /// Names the program and its first arguments; by default it is the running program itself.
  explicit Workers(std::vector<std::string> program = {});
  ~Workers();  ///< ends running processes by SIGTERM, and waits for them
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Starts a process in this directory. Throws std::runtime_error if the system cannot create it.
  void start(int id, const std::filesystem::path& directory, const std::vector<std::string>& arguments);

  /// Returns the processes that have ended since the last call; waits for the first one, at most `milliseconds`.
  std::vector<WorkerEnd> ended(int milliseconds);

  void signal_all(int signal) const;
  /// Signals the processes with those that they have started.
  void signal_groups(int signal) const;

  std::size_t running() const { return workers_.size(); }

 private:
  struct Worker {
    int id;
    ::pid_t process;
    int errors;  ///< reading end of its stderr; -1: closed
    std::string said;
  };

  void listen(int milliseconds);
  static void take_what_it_says(Worker& worker);

  std::vector<std::string> program_;
  std::vector<Worker> workers_;
};

}  // namespace hardbody
