#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace hardbody {

/// The bytes of a file that is read in parts.
class StoredBytes {
 public:
  virtual ~StoredBytes() = default;
  virtual std::uint64_t size() const = 0;
  /// `size` bytes from `position` on, all of which there are. Throws InputError if they cannot be read.
  virtual std::string read(std::uint64_t position, std::uint64_t size) const = 0;
};

/// A regular file on the disk, read as it is asked for; one that was longer when it was opened is reported, not
/// trusted. Throws InputError if it cannot be read.
std::unique_ptr<StoredBytes> open_stored_bytes(const std::filesystem::path& path);
/// Bytes in memory.
std::unique_ptr<StoredBytes> stored_bytes_in_memory(std::string bytes);

}  // namespace hardbody
