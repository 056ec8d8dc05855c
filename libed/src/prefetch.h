#pragma once

#include <cstddef>

namespace ed::internal {

/// Asks for the cache lines of an object that is read soon. Reads that do not wait for each other are what a processor
/// overlaps, but only as far as it looks ahead, which is a few pairs of bodies; of large systems most come from main
/// memory.
template <class T>
inline void prefetch(const T& object) {
  constexpr std::size_t kLine = 64;
  const char* const begin = reinterpret_cast<const char*>(&object);
  for (std::size_t at = 0; at < sizeof(T); at += kLine) __builtin_prefetch(begin + at);
  // The last line, where the object does not begin with one.
  if constexpr (sizeof(T) > 1 && alignof(T) < kLine) __builtin_prefetch(begin + sizeof(T) - 1);
}

}  // namespace ed::internal
