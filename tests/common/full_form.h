#pragma once

#include <cstdlib>
#include <string_view>

/// Returns whether an environment variable is 1.
inline bool is_set(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && std::string_view(value) == "1";
}

/// Returns whether the long form of the tests is asked for, that of the figures in docs/.
inline bool full_form() {
  return is_set("HARDBODY_FULL");
}

/// Returns whether a tenth of the usual draws is enough: the form of `tools/test --quick`.
inline bool quick_form() {
  return is_set("HARDBODY_QUICK");
}

/// Returns whether the build has no optimisation or has sanitizers, and is ten to thirty times slower.
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

/// Returns whether fewer cases are enough: in a slow build and in the quick form.
inline bool short_form() {
  return slow_build() || quick_form();
}

/// Returns the number of draws: `count`, or a tenth of it in the short form.
inline int repetitions(int count) {
  return short_form() ? count / 10 : count;
}
