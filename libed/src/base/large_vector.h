#pragma once

#include <cstddef>
#include <new>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace ed::internal {

/// Allocator that requests pages of 2 MB for large allocations, if the system has them. With small pages a collision of
/// a large system reads from more pages than a processor keeps addresses of.
template <class T>
class LargePages {
 public:
  using value_type = T;

  LargePages() = default;
  template <class U>
  LargePages(const LargePages<U>& /*other*/) noexcept {}  // NOLINT(google-explicit-constructor): required of allocators

  T* allocate(std::size_t number) {
    if (number > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_array_new_length();
    const std::size_t bytes = number * sizeof(T);
    void* const memory = ::operator new(bytes, alignment(number));
#if defined(MADV_HUGEPAGE)
    // A hint: if it is refused, small pages are used.
    if (large(number)) (void)::madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t number) {
    ::operator delete(memory, alignment(number));
  }

  template <class U>
  bool operator==(const LargePages<U>& /*other*/) const {
    return true;
  }

 private:
  static constexpr std::size_t kPage = std::size_t{2} << 20;

  static bool large(std::size_t number) {
    return number * sizeof(T) >= 2 * kPage;
  }
  static std::align_val_t alignment(std::size_t number) {
    return std::align_val_t{large(number) ? kPage : alignof(T)};
  }
};

/// Vector for the data of bodies and pairs that an event reads.
template <class T>
using LargeVector = std::vector<T, LargePages<T>>;

}  // namespace ed::internal
