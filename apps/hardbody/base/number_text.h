#pragma once

#include <optional>
#include <string_view>

namespace hardbody {

/// Returns the finite number that a text consists of, from its first character to its last; nullopt for any other text.
std::optional<double> finite_number(std::string_view text);

/// Returns the number that a text is, NaN for one that is not finite or beyond the range of a double; nullopt for a
/// text that is no number.
std::optional<double> number_or_nan(std::string_view text);

/// Returns the seconds of a positive number with a unit, as in 60s, 5m, 1.5h; nullopt for any other text.
std::optional<double> duration_seconds(std::string_view text);

/// Returns degrees of freedom in units of the number of bodies, "2N" or "3N", or the number itself.
std::string freedoms_text(long freedoms, int number);

}  // namespace hardbody
