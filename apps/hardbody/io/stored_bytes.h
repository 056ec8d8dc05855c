#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace hardbody {

/// Bytes of a file that is read in parts.
class StoredBytes {
 public:
  virtual ~StoredBytes() = default;
  virtual std::uint64_t size() const = 0;
  /// Returns `size` bytes from `position` on, all of which must exist. Throws InputError if they cannot be read.
  virtual std::string read(std::uint64_t position, std::uint64_t size) const = 0;
};

/// Opens a regular file on the disk, which is read on demand. If it becomes shorter after it was opened, an error is
/// reported. Throws InputError if it cannot be read.
std::unique_ptr<StoredBytes> open_stored_bytes(const std::filesystem::path& path);
/// Returns bytes in memory.
std::unique_ptr<StoredBytes> stored_bytes_in_memory(std::string bytes);

}  // namespace hardbody
