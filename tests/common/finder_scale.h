#pragma once

#include <cstdlib>
#include <string_view>

namespace finder_test {

/// Whether the counts of docs/validation.md are wanted (HARDBODY_FULL=1) instead of the short ones.
inline bool full_run() {
  const char* value = std::getenv("HARDBODY_FULL");
  return value != nullptr && std::string_view(value) == "1";
}

/// `count`, or `full` in the full run.
inline int scaled(int count, int full) { return full_run() ? full : count; }

}  // namespace finder_test
