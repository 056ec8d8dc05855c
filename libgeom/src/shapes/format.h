#pragma once

#include <array>
#include <charconv>
#include <string>

namespace geom::kernel {

/// A number in a message: with as many digits as tell it from every other one, so that what is refused does not look
/// like what is accepted.
inline std::string shown(double x) {
  std::array<char, 32> text{};
  const std::to_chars_result end = std::to_chars(text.data(), text.data() + text.size(), x);
  return {text.data(), end.ptr};
}

}  // namespace geom::kernel
