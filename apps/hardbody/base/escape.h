#pragma once

#include "base/find.h"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace hardbody {

/// Character and the text that replaces it.
struct Escape {
  char character;
  std::string_view text;
};

/// Returns a text with each of its characters that has an escape replaced.
inline std::string escaped(std::string_view text, std::span<const Escape> escapes) {
  std::string result;
  result.reserve(text.size());
  std::size_t copied = 0;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const Escape* escape = find_by(escapes, &Escape::character, text[k]);
    if (escape == nullptr) continue;
    result.append(text, copied, k - copied).append(escape->text);
    copied = k + 1;
  }
  return result.append(text, copied);
}

}  // namespace hardbody
