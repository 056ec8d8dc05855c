#pragma once

#include <cstddef>

namespace ed::internal {

/// Asks for a cache line that is read soon, where the compiler can say so.
inline void prefetch_line(const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address);
  // GCC takes a function that does nothing else for one without effect, and drops its calls.
  asm volatile("" : : "r"(address));
#else
  (void)address;
#endif
}

/// Asks for all lines of an object. Reads that do not wait for each other are overlapped by a processor, but only as
/// far as it looks ahead, which is a few pairs of bodies.
template <class T>
inline void prefetch(const T& object) {
  constexpr std::size_t kLine = 64;
  const char* const begin = reinterpret_cast<const char*>(&object);
  for (std::size_t at = 0; at < sizeof(T); at += kLine) prefetch_line(begin + at);
  // The last line, of an object that may begin within one.
  if constexpr (sizeof(T) > alignof(T) && alignof(T) < kLine) prefetch_line(begin + sizeof(T) - 1);
}

}  // namespace ed::internal
