#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace ed::internal {

/// Memory in pages of 2 MB where there is much of it and the system has them: of small pages, a collision of a large
/// system reads more than a processor keeps addresses of.
template <class T>
class LargePages {
 public:
  using value_type = T;

  LargePages() = default;
  template <class U>
  explicit LargePages(const LargePages<U>& /*other*/) {}

  T* allocate(std::size_t number) {
    if (number > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_array_new_length();
    if (!large(number)) return static_cast<T*>(::operator new (number * sizeof(T), std::align_val_t{alignof(T)}));
    const std::size_t bytes = (number * sizeof(T) + kPage - 1) / kPage * kPage;
    void* const memory = std::aligned_alloc(kPage, bytes);
    if (memory == nullptr) throw std::bad_alloc();
#if defined(__linux__)
    // A wish: where it is refused, small pages do.
    (void)::madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t number) {
    if (large(number)) {
      std::free(memory);
    } else {
      ::operator delete (memory, std::align_val_t{alignof(T)});
    }
  }

  friend bool operator==(const LargePages& /*a*/, const LargePages& /*b*/) {
    return true;
  }

 private:
  static constexpr std::size_t kPage = std::size_t{2} << 20;

  static bool large(std::size_t number) {
    return number * sizeof(T) >= 2 * kPage;
  }
};

/// Of what large systems have one for each body or pair.
template <class T>
using LargeVector = std::vector<T, LargePages<T>>;

}  // namespace ed::internal
