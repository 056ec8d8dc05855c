#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace hardbody {

/// What follows the last dot of a dotted name, or the whole name.
std::string_view last_part(std::string_view name);

/// The number of letters to insert, delete, replace or swap with their neighbour that turns one word into the
/// other.
int edit_distance(std::string_view a, std::string_view b);

/// The known name that `word` is most likely a misspelling of; nothing if none is near. A dotted name whose
/// last part is spelt like the word's last part counts as near: the key stands in the wrong section.
std::optional<std::string> nearest_name(std::string_view word, std::span<const std::string_view> known);

}  // namespace hardbody
