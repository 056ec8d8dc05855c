#include "registry/key_names.h"

#include "base/find.h"

#include <algorithm>

namespace hardbody {
const std::vector<KeyName>& key_names() {
  static const std::vector<KeyName> all = {
      {"shape.aspect_ratio", "aspect ratio", "X₀"},
      {"system.packing_fraction", "packing fraction", "φ"},
      {"system.number", "number of bodies", "N"},
      {"system.nematic_order", "nematic order of the start", "S₀"},
  };
  return all;
}

std::string key_words(std::string_view key) {
  std::string words(key.substr(key.rfind('.') + 1));
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string key_label(std::string_view key) {
  const KeyName* known = find_by(key_names(), &KeyName::key, key);
  return known == nullptr ? key_words(key) : std::string(known->name) + " " + std::string(known->symbol);
}

std::string key_symbol(std::string_view key) {
  const KeyName* known = find_by(key_names(), &KeyName::key, key);
  return known == nullptr ? key_words(key) : std::string(known->symbol);
}

}  // namespace hardbody
