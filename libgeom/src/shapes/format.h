#pragma once

#include <array>
#include <charconv>
#include <string>

namespace geom::kernel {

/// Formats a number for a message, with enough digits to distinguish it from every other one, so that a refused value
/// does not look like an accepted one.
inline std::string shown(double x) {
  std::array<char, 32> text{};
  const std::to_chars_result end = std::to_chars(text.data(), text.data() + text.size(), x);
  return {text.data(), end.ptr};
}

}  // namespace geom::kernel
