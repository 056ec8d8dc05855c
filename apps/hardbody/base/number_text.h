#pragma once

#include <optional>
#include <string_view>

namespace hardbody {

/// A text that is a finite number from its first character to its last; nothing for any other.
std::optional<double> finite_number(std::string_view text);

/// Returns degrees of freedom of so many bodies: "2N", "3N", or the number itself.
std::string freedoms_text(long freedoms, int number);

}  // namespace hardbody
