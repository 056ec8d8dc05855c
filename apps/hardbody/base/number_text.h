#pragma once

#include <optional>
#include <string_view>

namespace hardbody {

/// A text that is a finite number from its first character to its last; nothing for any other.
std::optional<double> finite_number(std::string_view text);

}  // namespace hardbody
