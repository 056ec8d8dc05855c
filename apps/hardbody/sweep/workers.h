#pragma once

/// Other processes of this very program, a few at a time.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace hardbody {

/// How a process has ended.
struct WorkerEnd {
  int id = 0;             ///< as it was started with
  int status = 0;         ///< exit status, or 128 + the signal that ended it
  std::string last_line;  ///< of what it said on stderr: why it failed
};

/// Starts the program again with other arguments and waits for its processes. Their stdout goes nowhere, of stderr the
/// last line is kept. A process is in a group of its own, so that Ctrl-C reaches it only by way of `signal_all`, and it
/// gets SIGTERM if this one dies.
class Workers {
 public:
  Workers() = default;
  ~Workers();  ///< ends those that still run by SIGTERM, and waits
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// In that directory. Throws std::runtime_error if the system has no more processes.
  void start(int id, const std::filesystem::path& directory, const std::vector<std::string>& arguments);

  /// Those that have ended since the last call; waits for the first one, `milliseconds` at the most.
  std::vector<WorkerEnd> ended(int milliseconds);

  void signal_all(int signal) const;

  std::size_t running() const { return workers_.size(); }

 private:
  struct Worker {
    int id;
    ::pid_t process;
    int errors;  ///< the reading end of its stderr; -1: at its end
    std::string said;
  };

  void listen(int milliseconds);
  static void take_what_it_says(Worker& worker);

  std::vector<Worker> workers_;
};

}  // namespace hardbody
