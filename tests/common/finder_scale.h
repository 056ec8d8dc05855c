#pragma once

#include <common/full_form.h>

namespace finder_test {

/// Returns whether this is a build without optimisation or with sanitizers, which is ten to thirty times slower.
constexpr bool slow_build() {
#if !defined(__OPTIMIZE__) || defined(__SANITIZE_ADDRESS__)
  return true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
  return true;
#else
  return false;
#endif
#else
  return false;
#endif
}

/// Returns `count`, or `full` in the full run, or a tenth of it in a slow build.
inline int scaled(int count, int full) {
  if (full_form()) return full;
  return slow_build() ? count / 10 : count;
}

}  // namespace finder_test
