#include "sweep/workers.h"

#include "base/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace hardbody {
namespace {

/// Path of the running program itself, even if another one has been installed under its name since.
constexpr const char* kThisProgram = "/proc/self/exe";
constexpr int kMostJobs = 1024;
constexpr int kClosed = -1;              ///< descriptor that poll() ignores
constexpr int kSilentLook = 10;          ///< milliseconds between two looks at processes that have closed their stderr
constexpr std::size_t kMostSaid = 4096;  ///< bytes of stderr that are kept

std::runtime_error cannot_start(int error) {
  return std::runtime_error(fmt::format("a process cannot be started: {}", std::strerror(error)));
}

/// Runs between fork and exec: only functions that are safe there are called.
[[noreturn]] void become_worker(const char* directory, const char* program, char* const* arguments, int errors,
                                ::pid_t parent) {
  (void)::setpgid(0, 0);
  (void)::prctl(PR_SET_PDEATHSIG, SIGTERM);
  // Schedulers send it to all processes of a task; whoever started this one decides.
  (void)std::signal(SIGUSR1, SIG_IGN);
  const int nothing = ::open("/dev/null", O_RDWR);
  // The parent may have died before its death could be signalled.
  const bool ready = ::getppid() == parent && ::chdir(directory) == 0 && nothing >= 0 &&
                     ::dup2(nothing, STDIN_FILENO) >= 0 && ::dup2(nothing, STDOUT_FILENO) >= 0 &&
                     ::dup2(errors, STDERR_FILENO) >= 0;
  if (ready) (void)::execv(program, arguments);
  ::_exit(Workers::kNotStarted);
}

std::string last_line(std::string_view text) {
  while (!text.empty() && text.back() == '\n') text.remove_suffix(1);
  const std::size_t begin = text.rfind('\n');
  return std::string(begin == std::string_view::npos ? text : text.substr(begin + 1));
}

int exit_status(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

int jobs_on_this_machine(const std::optional<int>& jobs) {
  const int number = jobs.value_or(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  if (number >= 1 && number <= kMostJobs) return number;
  throw InputError(fmt::format("--jobs is {}; accepted: an integer from 1 to {}", number, kMostJobs));
}

Workers::Workers(std::vector<std::string> program) : program_(std::move(program)) {}

Workers::~Workers() {
  signal_all(SIGTERM);
  for (const Worker& worker : workers_) {
    if (worker.errors != kClosed) ::close(worker.errors);
    while (::waitpid(worker.process, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
}

void Workers::start(int id, const std::filesystem::path& directory, const std::vector<std::string>& arguments) {
  // Made before the fork: nothing is allocated after it.
  std::vector<std::string> words = program_.empty() ? std::vector<std::string>{"hardbody"} : program_;
  const std::string program = program_.empty() ? kThisProgram : program_.front();
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw cannot_start(errno);
  (void)::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  const ::pid_t parent = ::getpid();
  const ::pid_t process = ::fork();
  if (process == 0) become_worker(directory.c_str(), program.c_str(), pointers.data(), ends[1], parent);
  const int error = errno;
  ::close(ends[1]);
  if (process < 0) {
    ::close(ends[0]);
    throw cannot_start(error);
  }
  workers_.push_back({id, process, ends[0], {}});
}

void Workers::take_what_it_says(Worker& worker) {
  if (worker.errors == kClosed) return;
  char buffer[1024];
  for (;;) {
    const ::ssize_t read = ::read(worker.errors, buffer, sizeof buffer);
    if (read == 0) {
      // It has ended, or goes on without stderr: poll() would report the closed pipe at once, again and again.
      ::close(worker.errors);
      worker.errors = kClosed;
    }
    if (read <= 0) return;
    worker.said.append(buffer, static_cast<std::size_t>(read));
    if (worker.said.size() > 2 * kMostSaid) worker.said.erase(0, worker.said.size() - kMostSaid);
  }
}

void Workers::listen(int milliseconds) {
  std::vector<::pollfd> waiting;
  for (const Worker& worker : workers_) {
    waiting.push_back({worker.errors, POLLIN, 0});
    if (worker.errors == kClosed) milliseconds = std::min(milliseconds, kSilentLook);
  }
  // A signal ends the wait early.
  (void)::poll(waiting.data(), waiting.size(), milliseconds);
  for (Worker& worker : workers_) take_what_it_says(worker);
}

std::vector<WorkerEnd> Workers::ended(int milliseconds) {
  listen(milliseconds);
  std::vector<WorkerEnd> ends;
  std::erase_if(workers_, [&](Worker& worker) {
    int status = 0;
    const ::pid_t ended = ::waitpid(worker.process, &status, WNOHANG);
    // Other code of this process has waited for it, or SIGCHLD is ignored: it has ended with a status that
    // nobody knows. Its results tell.
    const bool lost = ended < 0 && errno == ECHILD;
    if (ended != worker.process && !lost) return false;
    take_what_it_says(worker);
    if (worker.errors != kClosed) ::close(worker.errors);
    ends.push_back({worker.id, exit_status(status), WIFSIGNALED(status), last_line(worker.said)});
    return true;
  });
  return ends;
}

void Workers::signal_all(int signal) const {
  for (const Worker& worker : workers_) (void)::kill(worker.process, signal);
}

void Workers::signal_groups(int signal) const {
  for (const Worker& worker : workers_) (void)::kill(-worker.process, signal);
}

}  // namespace hardbody
