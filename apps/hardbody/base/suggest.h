#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace hardbody {

/// Returns the part of a dotted name after its last dot, or the whole name.
std::string_view last_part(std::string_view name);

/// Returns the number of letters to insert, delete, replace or swap with their neighbour that turns one word into the
/// other.
int edit_distance(std::string_view a, std::string_view b);

/// Returns the known name that `word` most likely misspells; nullopt if none is near. A dotted name whose last part is
/// spelt like the word's last part counts as near: the key is in the wrong section.
std::optional<std::string> nearest_name(std::string_view word, std::span<const std::string_view> known);

}  // namespace hardbody
