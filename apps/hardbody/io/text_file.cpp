#include "io/text_file.h"

#include "base/errors.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

[[noreturn]] void fail_to_write(const fs::path& path, int error) {
  throw WriteError(path, error);
}

/// File descriptor that is closed by the destructor.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int operator*() const { return number_; }

 private:
  int number_;
};

/// Writes everything into `temporary` and flushes it to the disk; messages name `path`.
void write_pieces(const fs::path& temporary, const fs::path& path, const std::function<void(const Sink&)>& make) {
  File file(std::fopen(temporary.c_str(), "wb"));
  if (!file) fail_to_write(path, errno);
  make([&](std::string_view piece) {
    if (std::fwrite(piece.data(), 1, piece.size(), file.get()) != piece.size()) fail_to_write(path, errno);
  });
  if (std::fflush(file.get()) != 0 || ::fsync(::fileno(file.get())) != 0) fail_to_write(path, errno);
  if (std::fclose(file.release()) != 0) fail_to_write(path, errno);
}

/// Returns whether all of it could be written; errno gives the reason.
bool write_all(int file, ::off_t place, std::string_view content) {
  for (std::size_t done = 0; done < content.size();) {
    const ::ssize_t written =
        ::pwrite(file, content.data() + done, content.size() - done, place + static_cast<::off_t>(done));
    if (written <= 0 && !(written < 0 && errno == EINTR)) return false;
    if (written > 0) done += static_cast<std::size_t>(written);
  }
  return true;
}

bool flushed(int file, Flush flush) {
  return flush == Flush::later || ::fsync(file) == 0;
}

/// Returns a link's target, or the path itself.
fs::path behind_links(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  // A link to a file that does not exist yet: the file will be created.
  if (!fs::exists(status))
    return fs::is_symlink(fs::symlink_status(path, ignored))
               ? fs::weakly_canonical(path.parent_path() / fs::read_symlink(path))
               : path;
  if (!fs::is_regular_file(status) && !fs::is_directory(status)) {
    throw WriteError(path, EINVAL, "it is not a file");
  }
  return fs::is_symlink(fs::symlink_status(path, ignored)) ? fs::canonical(path, ignored) : path;
}

/// Makes the names in a directory survive a loss of power, if the file system supports that.
void flush_names(const fs::path& directory) {
  const Descriptor file(::open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (*file >= 0) (void)::fsync(*file);
}

}  // namespace

fs::path absolute_path(const fs::path& path) {
  const fs::path whole = fs::absolute(path);
  fs::path result = whole.root_path();
  std::error_code ignored;
  for (const fs::path& name : whole.relative_path()) {
    if (name.empty() || name == ".") continue;
    if (name != "..") {
      result /= name;
      continue;
    }
    if (fs::is_symlink(fs::symlink_status(result, ignored))) result = fs::weakly_canonical(result);
    result = result.parent_path();
  }
  return result;
}

WriteError::WriteError(const fs::path& path, int error, const std::string& why)
    : std::runtime_error(
          fmt::format("{}: cannot be written: {}", path.string(), why.empty() ? std::strerror(error) : why.c_str())),
      path_(path.string()),
      number_(error),
      reason_(std::string(what()).substr(path_.size() + 2)),
      no_room_(error == ENOSPC || error == EDQUOT || error == EFBIG) {}

std::string read_file(const fs::path& path, std::size_t limit) {
  const auto fail = [&](const char* why) {
    return InputError(fmt::format("{}: cannot be read: {}; accepted: a readable file", path.string(), why));
  };
  const auto too_long = [&] {
    return InputError(fmt::format("{}: is longer than {} bytes; accepted: shorter files", path.string(), limit));
  };
  // O_NONBLOCK: opening a pipe would otherwise wait for its writer.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status = {};
  if (*file < 0 || ::fstat(*file, &status) != 0) throw fail(std::strerror(errno));
  if (S_ISDIR(status.st_mode)) throw fail("it is a directory");
  if (!S_ISREG(status.st_mode)) throw fail("it is not a file");
  if (static_cast<std::uint64_t>(status.st_size) > limit) throw too_long();
  // One byte more than the size at opening, to detect the end: a large file needs no more memory than it has bytes.
  std::string content(static_cast<std::size_t>(status.st_size) + 1, '\0');
  std::size_t done = 0;
  for (;;) {
    const ::ssize_t read = ::read(*file, content.data() + done, content.size() - done);
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) throw fail(std::strerror(errno));
    if (read == 0) break;
    done += static_cast<std::size_t>(read);
    if (done > limit) throw too_long();
    if (done == content.size()) content.resize(2 * content.size());
  }
  content.resize(done);
  return content;
}

void write_file(const fs::path& path, std::string_view content) {
  write_file(path, [content](const Sink& sink) { sink(content); });
}

void check_replaceable(const fs::path& path, std::string_view beginning) {
  const auto refuse = [&](const char* why) {
    throw InputError(
        fmt::format("{}: {}; accepted: a new file, or one that this command has written", path.string(), why));
  };
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) refuse("is a directory");
  if (fs::exists(status) && !fs::is_regular_file(status)) refuse("is not a file");
  if (!fs::exists(status) || fs::file_size(path, ignored) == 0) return;
  std::ifstream file(path, std::ios::binary);
  std::string found(beginning.size(), '\0');
  file.read(found.data(), static_cast<std::streamsize>(found.size()));
  if (!file || found != beginning) refuse("exists and is something else");
}

void write_file(const fs::path& path, const std::function<void(const Sink&)>& make) {
  const fs::path target = behind_links(path);
  fs::path temporary = target;
  temporary += ".part";
  try {
    write_pieces(temporary, path, make);
    if (std::rename(temporary.c_str(), target.c_str()) != 0) fail_to_write(path, errno);
    flush_names(target.parent_path());
  } catch (...) {
    std::remove(temporary.c_str());
    throw;
  }
}

void write_at(const fs::path& path, std::uint64_t position, std::string_view content, Flush flush) {
  const auto place = static_cast<::off_t>(position);
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
  if (*file < 0) fail_to_write(path, errno);
  if (::ftruncate(*file, place) == 0 && write_all(*file, place, content) && flushed(*file, flush)) return;
  const int error = errno;
  // Truncation needs no room; if even this fails, the next call cuts off the remainder.
  (void)!::ftruncate(*file, place);
  fail_to_write(path, error);
}

void cut_off(const fs::path& path, std::uint64_t position) {
  (void)!::truncate(path.c_str(), static_cast<::off_t>(position));
}

void overwrite_at(const fs::path& path, std::uint64_t position, std::string_view content, Flush flush) {
  const Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  const bool good = *file >= 0 && write_all(*file, static_cast<::off_t>(position), content) && flushed(*file, flush);
  if (!good) fail_to_write(path, errno);
}

void flush_file(const fs::path& path) {
  overwrite_at(path, 0, "");
}

std::string one_line(std::string_view text, std::size_t longest) {
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool blank = byte <= ' ' || byte == 127;
    if (blank && (line.empty() || line.back() == ' ')) continue;
    line += blank ? ' ' : c;
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  if (line.size() > longest) line = line.substr(0, longest) + "...";
  return line;
}

}  // namespace hardbody
