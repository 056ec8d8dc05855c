#include "sweep/tasks/task_lock.h"

#include "base/errors.h"
#include "io/text_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <fstream>
#include <optional>
#include <random>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTaskLockFile = "task.lock";
constexpr std::size_t kLongestTaskLock = 4096;

std::string first_line(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

std::string host_name() {
  char name[256] = {};
  (void)::gethostname(name, sizeof name - 1);
  return name;
}

/// Distinguishes hosts of one name. A host that was booted has a new one.
std::string boot_id() {
  return first_line("/proc/sys/kernel/random/boot_id");
}

/// Returns the namespace of process numbers: containers of one host may have their own.
std::string process_namespace() {
  char name[64] = {};
  (void)!::readlink("/proc/self/ns/pid", name, sizeof name - 1);
  return name;
}

/// Returns the time at which a process began, in ticks since boot; empty if there is none. Numbers of processes are
/// used again.
std::string start_of(long process) {
  const std::string status = first_line(fmt::format("/proc/{}/stat", process));
  // The name, in brackets, may contain anything; the time is the 20th word after it.
  std::size_t at = status.rfind(')');
  for (int word = 0; word < 20 && at != std::string::npos; ++word) at = status.find(' ', at + 1);
  return at == std::string::npos ? "" : status.substr(at + 1, status.find(' ', at + 1) - at - 1);
}

std::string unique_number() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

std::string own_content() {
  const nlohmann::json json = {{"host", host_name()},
                               {"boot", boot_id()},
                               {"namespace", process_namespace()},
                               {"process", ::getpid()},
                               {"start", start_of(::getpid())},
                               {"number", unique_number()}};
  return json.dump() + "\n";
}

/// Returns the content of a lock; nullopt if there is none.
std::optional<std::string> content_of(const fs::path& file) {
  if (!fs::exists(file)) return std::nullopt;
  try {
    return read_file(file, kLongestTaskLock);
  } catch (const InputError&) {
    return std::nullopt;  // removed meanwhile
  }
}

/// Creates a file that was not there. Returns false if it was. Throws WriteError.
bool create(const fs::path& file, const std::string& content) {
  const int descriptor = ::open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
  if (descriptor < 0 && errno == EEXIST) return false;
  if (descriptor < 0) throw WriteError(file, errno);
  const ::ssize_t written = ::write(descriptor, content.data(), content.size());
  const int error = written < 0 ? errno : ENOSPC;
  ::close(descriptor);
  if (written == static_cast<::ssize_t>(content.size())) return true;
  (void)::unlink(file.c_str());
  throw WriteError(file, error);
}

/// Returns the seconds since the file was touched, by the clock of the file system; 0 if that cannot be asked, because
/// its disk is full or may only be read.
double age_of(const fs::path& file) {
  fs::path probe = file;
  probe += fmt::format(".{}", unique_number());
  struct stat now = {};
  struct stat then = {};
  try {
    if (!create(probe, "\n")) return 0;
  } catch (const WriteError&) {
    return 0;
  }
  const bool known = ::stat(probe.c_str(), &now) == 0 && ::stat(file.c_str(), &then) == 0;
  (void)::unlink(probe.c_str());
  return known ? static_cast<double>(now.st_mtim.tv_sec - then.st_mtim.tv_sec) : 0;
}

/// Returns whether the process of a lock is known to have ended: it ran on this host.
bool has_ended(const nlohmann::json& lock) {
  const bool here = lock.value("host", "") == host_name() && lock.value("boot", "") == boot_id() &&
                    lock.value("namespace", "") == process_namespace();
  if (!here) return false;
  const long process = lock.value("process", 0L);
  return (::kill(static_cast<::pid_t>(process), 0) != 0 && errno == ESRCH) ||
         start_of(process) != lock.value("start", "");
}

bool is_stale(const fs::path& file, const std::string& content) {
  // A lock without content is being written, or its disk was full.
  const nlohmann::json lock = nlohmann::json::parse(content, nullptr, /*allow_exceptions=*/false);
  if (lock.is_object() && has_ended(lock)) return true;
  return age_of(file) > static_cast<double>(TaskLock::kStale.count());
}

std::string holder_in(const std::string& content) {
  const nlohmann::json lock = nlohmann::json::parse(content, nullptr, /*allow_exceptions=*/false);
  if (!lock.is_object()) return "another task";
  return fmt::format("process {} on {}", lock.value("process", 0L), one_line(lock.value("host", "another host"), 60));
}

/// Removes a stale lock, unless another task has been faster. Its own lock is put back; if yet another one has been
/// created meanwhile, the task of the first finds that out at its next heartbeat.
void remove_stale(const fs::path& file, const std::string& stale) {
  fs::path aside = file;
  aside += fmt::format(".{}", unique_number());
  if (std::rename(file.c_str(), aside.c_str()) != 0) return;
  if (content_of(aside) != stale) (void)!::link(aside.c_str(), file.c_str());
  (void)::unlink(aside.c_str());
}

}  // namespace

TaskLock::TaskLock(const fs::path& directory) : file_(directory / kTaskLockFile), content_(own_content()) {
  constexpr int kTries = 10;
  for (int k = 0; k < kTries; ++k) {
    if (create(file_, content_)) return;
    const std::optional<std::string> other = content_of(file_);
    if (!other) continue;
    if (!is_stale(file_, *other)) throw Held{holder_in(*other)};
    remove_stale(file_, *other);
  }
  throw Held{"another task"};
}

TaskLock::~TaskLock() {
  if (!content_.empty() && content_of(file_) == content_) (void)::unlink(file_.c_str());
}

bool TaskLock::touch() const {
  if (content_of(file_) != content_) return false;
  (void)::utimensat(AT_FDCWD, file_.c_str(), nullptr, 0);
  return true;
}

bool has_task(const fs::path& directory) {
  const fs::path file = directory / kTaskLockFile;
  const std::optional<std::string> content = content_of(file);
  return content && !is_stale(file, *content);
}

}  // namespace hardbody
