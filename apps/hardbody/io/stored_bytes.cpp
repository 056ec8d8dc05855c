#include "io/stored_bytes.h"

#include "base/errors.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hardbody {
namespace {

class DiskBytes final : public StoredBytes {
 public:
  explicit DiskBytes(const std::filesystem::path& path)
      // O_NONBLOCK: opening a pipe would otherwise wait for its writer.
      : name_(path.string()), descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    struct stat status = {};
    if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) {
      const int error = errno;
      if (descriptor_ >= 0) ::close(descriptor_);
      throw unreadable(std::strerror(error));
    }
    if (!S_ISREG(status.st_mode)) {
      ::close(descriptor_);
      throw unreadable(S_ISDIR(status.st_mode) ? "it is a directory" : "it is not a file");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~DiskBytes() override { ::close(descriptor_); }
  DiskBytes(const DiskBytes&) = delete;
  DiskBytes& operator=(const DiskBytes&) = delete;

  std::uint64_t size() const override { return size_; }

  std::string read(std::uint64_t position, std::uint64_t size) const override {
    std::string bytes(size, '\0');
    for (std::uint64_t done = 0; done < size;) {
      const ::ssize_t got =
          ::pread(descriptor_, bytes.data() + done, size - done, static_cast<::off_t>(position + done));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) throw unreadable(std::strerror(errno));
      if (got == 0) throw unreadable("it has become shorter since it was opened");
      done += static_cast<std::uint64_t>(got);
    }
    return bytes;
  }

 private:
  InputError unreadable(const char* why) const {
    return InputError(fmt::format("{}: cannot be read: {}; accepted: a readable file", name_, why));
  }

  std::string name_;
  int descriptor_;
  std::uint64_t size_ = 0;
};

class MemoryBytes final : public StoredBytes {
 public:
  explicit MemoryBytes(std::string bytes) : bytes_(std::move(bytes)) {}
  std::uint64_t size() const override { return bytes_.size(); }
  std::string read(std::uint64_t position, std::uint64_t size) const override { return bytes_.substr(position, size); }

 private:
  std::string bytes_;
};

}  // namespace

std::unique_ptr<StoredBytes> open_stored_bytes(const std::filesystem::path& path) {
  return std::make_unique<DiskBytes>(path);
}

std::unique_ptr<StoredBytes> stored_bytes_in_memory(std::string bytes) {
  return std::make_unique<MemoryBytes>(std::move(bytes));
}

}  // namespace hardbody
