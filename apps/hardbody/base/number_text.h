#pragma once

#include <optional>
#include <string_view>

namespace hardbody {

/// Returns the finite number that a text consists of, from its first character to its last; nullopt for any other text.
std::optional<double> finite_number(std::string_view text);

}  // namespace hardbody
