#include "io/line_reader.h"

#include "base/errors.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hardbody {
namespace {

constexpr std::size_t kBufferSize = 1 << 16;

InputError unreadable(const std::string& name, int error) {
  return InputError(
      fmt::format("{}: cannot be read: {}; accepted: a file, or - for standard input", name, std::strerror(error)));
}

}  // namespace

LineReader::LineReader(const std::string& path, std::size_t longest)
    : name_(path == "-" ? "standard input" : path),
      longest_(longest),
      descriptor_(path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC)),
      buffer_(kBufferSize) {
  struct stat status = {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) throw unreadable(name_, errno);
  is_regular_file_ = S_ISREG(status.st_mode);
}

LineReader::~LineReader() {
  if (descriptor_ != STDIN_FILENO) ::close(descriptor_);
}

bool LineReader::next() {
  line_.clear();
  too_long_ = false;
  if (unread_.empty() && !fill()) return false;
  ++number_;
  do {
    const std::size_t end = unread_.find('\n');
    append(unread_.substr(0, end));
    if (end != std::string_view::npos) {
      unread_.remove_prefix(end + 1);
      return true;
    }
  } while (fill());
  // The last line may lack a line break.
  unread_ = {};
  return true;
}

/// Fills the buffer; returns false at the end. It uses read(), not stdio, which would wait for a full buffer.
bool LineReader::fill() {
  ssize_t size = 0;
  do {
    size = ::read(descriptor_, buffer_.data(), buffer_.size());
  } while (size < 0 && errno == EINTR);
  if (size < 0) throw unreadable(name_, errno);
  unread_ = {buffer_.data(), static_cast<std::size_t>(size)};
  return size > 0;
}

void LineReader::append(std::string_view piece) {
  too_long_ = too_long_ || line_.size() + piece.size() > longest_;
  if (too_long_) {
    line_.clear();
  } else {
    line_.append(piece);
  }
}

}  // namespace hardbody
