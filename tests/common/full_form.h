#pragma once

#include <cstdlib>
#include <string_view>

/// Returns whether HARDBODY_FULL=1 is set, which selects the long form of the tests, that of the figures in docs/.
inline bool full_form() {
  const char* value = std::getenv("HARDBODY_FULL");
  return value != nullptr && std::string_view(value) == "1";
}
