#pragma once

/// Names of config keys for readers: the axes of maps and plots.

#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Name of a key in words, with its symbol.
struct KeyName {
  std::string_view key;   ///< section.key
  std::string_view name;  ///< "packing fraction"
  std::string_view symbol;
};

/// Returns the keys that have a symbol.
const std::vector<KeyName>& key_names();

/// Returns the last part of a key in words: "packing fraction".
std::string key_words(std::string_view key);

/// Returns the label of an axis, "packing fraction φ"; of a key without a symbol its name in words.
std::string key_label(std::string_view key);

/// Returns the symbol of a key, "φ"; of a key without one its name in words.
std::string key_symbol(std::string_view key);

}  // namespace hardbody
