#pragma once

#include <cstddef>

namespace hardbody::python {

/// Smallest size of memory that is worth keeping, bytes.
inline constexpr std::size_t kLeastKept = std::size_t{1} << 20;

/// Largest total of memory that is kept, bytes: the results of 2 million distances.
inline constexpr std::size_t kMostKept = std::size_t{1} << 28;

/// Memory of a large result. When it is dropped it is kept for the next result of about that size, up to kMostKept in
/// all: clearing new pages takes the system up to a fifth of the time in which distances are computed.
class KeptMemory {
 public:
  /// Takes memory. Throws std::bad_alloc if there is none.
  explicit KeptMemory(std::size_t bytes);
  ~KeptMemory();
  KeptMemory(const KeptMemory&) = delete;
  KeptMemory& operator=(const KeptMemory&) = delete;

  void* data() const { return data_; }

 private:
  void* data_;
  std::size_t size_;
};

/// Gives back the memory that is kept.
void release_kept_memory();

}  // namespace hardbody::python
