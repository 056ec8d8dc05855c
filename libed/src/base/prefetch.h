#pragma once

#include <cstddef>

namespace ed::internal {

/// Prefetches a cache line that is read soon, if the compiler supports that.
inline void prefetch_line(const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address);
  // GCC regards a function that does nothing else as without effect, and drops its calls.
  asm volatile("" : : "r"(address));
#else
  (void)address;
#endif
}

/// Prefetches all lines of an object. A processor overlaps independent reads by itself, but only as far as it looks
/// ahead, which is a few pairs of bodies.
template <class T>
inline void prefetch(const T& object) {
  constexpr std::size_t kLine = 64;
  const char* const begin = reinterpret_cast<const char*>(&object);
  for (std::size_t at = 0; at < sizeof(T); at += kLine) prefetch_line(begin + at);
  // The last line of an object that may begin within a line.
  if constexpr (sizeof(T) > alignof(T) && alignof(T) < kLine) prefetch_line(begin + sizeof(T) - 1);
}

}  // namespace ed::internal
