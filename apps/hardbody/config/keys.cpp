#include "config/keys.h"

#include "base/errors.h"
#include "base/find.h"
#include "base/suggest.h"
#include "io/text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

namespace hardbody {
namespace {

constexpr std::string_view kSpecies = "species";

/// Returns the sections of the table in its order; the first, "", is that of the keys at the top.
const std::vector<std::string_view>& sections() {
  static const std::vector<std::string_view> list = [] {
    std::vector<std::string_view> found;
    for (const Key& key : keys()) found.push_back(section_of(key.name));
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }();
  return list;
}

bool known_section(std::string_view name) {
  return !name.empty() && std::find(sections().begin(), sections().end(), name) != sections().end();
}

std::vector<std::string_view> key_names() {
  std::vector<std::string_view> names;
  for (const Key& key : keys()) names.push_back(key.name);
  return names;
}

const Key& key_called(std::string_view name) {
  return *find_by(keys(), &Key::name, name);
}

std::string full_name(std::string_view section, std::string_view name) {
  return section.empty() ? std::string(name) : fmt::format("{}.{}", section, name);
}

// ---- Names

/// Returns "[2]" of species[2] and species[2].mass; empty where there is none.
std::string_view index_in(std::string_view name) {
  const std::size_t open = name.find('[');
  const std::size_t close = name.find(']');
  if (open == std::string_view::npos || close == std::string_view::npos || close < open) return {};
  return name.substr(open, close - open + 1);
}

/// Returns species[2].mass of species.mass and [2].
std::string with_index(std::string_view key, std::string_view index) {
  std::string result(key);
  return section_of(key) == kSpecies ? result.insert(result.find('.'), index) : result;
}

void check_sections(const TomlDocument& document) {
  for (const Section& section : document.sections) {
    const bool several = section.several;
    const std::string name = several ? without_index(section.name) : section.name;
    if (known_section(name) && several == (name == kSpecies)) continue;
    if (known_section(name)) {
      throw InputError(fmt::format(
          "{}: [{}] is {}; accepted: {}", section.where, name, several ? "there as an array, [[..]]" : "one section",
          several ? fmt::format("[{}], once", name) : std::string("[[species]], one for each kind of bodies")));
    }
    const auto nearest = nearest_name(name, std::span(sections()).subspan(1));
    throw InputError(
        fmt::format("{}: unknown section [{}]{}; accepted: [system], [start], [shape] or [[species]], [dynamics], "
                    "[equilibration], [production], [output]",
                    section.where, one_line(name, 40), nearest ? fmt::format(", did you mean [{}]?", *nearest) : ""));
  }
}

/// Refuses the file of a sweep where the config of one run is read.
void check_no_sweep(const TomlDocument& document) {
  for (const Section& section : document.sections) {
    if (without_index(section.name) != "grid") continue;
    throw InputError(fmt::format(
        "{}: [grid] makes this a sweep: hardbody sweep takes it; accepted: the config of one run", section.where));
  }
  for (const char* key : {"base", "chain", "replicas"}) {
    const Entry* entry = document.find(key);
    if (entry == nullptr) continue;
    throw InputError(fmt::format(
        "{}: {} is a key of sweeps: hardbody sweep takes them; accepted: the config of one run", entry->where, key));
  }
}

/// Returns "system.number, system.packing_fraction", the keys of the key's section; all keys for a key without a
/// section.
std::string keys_near(std::string_view key) {
  const std::string_view section = key.substr(0, key.find('.') + 1);
  std::vector<std::string_view> near = key_names();
  std::erase_if(near, [&](std::string_view known) { return !known.starts_with(section); });
  return fmt::format("{}", fmt::join(near, ", "));
}

/// Refuses a key of a [[species]] that the file does not have, from the command line.
void check_index(const TomlDocument& document, const Entry& entry) {
  const std::string_view section = section_of(entry.key);
  if (!section.starts_with(kSpecies)) return;
  int number = 0;
  for (const Section& s : document.sections) {
    if (s.name == section) return;
    if (s.several) ++number;
  }
  throw InputError(number == 0 ? fmt::format("{}: {} needs sections [[species]] in the file, which has none; accepted: "
                                             "[[species]], or keys of [shape]",
                                             entry.where, entry.key)
                               : fmt::format("{}: there is no {} in the file; accepted: species[1] to species[{}]",
                                             entry.where, section, number));
}

}  // namespace

std::string_view section_of(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  return dot == std::string_view::npos ? "" : name.substr(0, dot);
}

std::string without_index(std::string_view name) {
  const std::size_t open = name.find('[');
  const std::size_t close = name.find(']');
  std::string result(name);
  return close == std::string::npos || close < open ? result : result.erase(open, close - open + 1);
}

std::string species_name(std::size_t index) {
  return fmt::format("species[{}]", index + 1);
}

void check_names(const TomlDocument& document) {
  check_no_sweep(document);
  check_sections(document);
  const std::vector<std::string_view> known = key_names();
  for (const Entry& entry : document.entries) {
    const std::string key = without_index(entry.key);
    const std::string_view index = index_in(entry.key);
    const bool indexed = index.empty() || entry.key == with_index(key, index);
    if (indexed && std::find(known.begin(), known.end(), key) != known.end()) {
      check_index(document, entry);
      continue;
    }
    if (entry.key == kSpecies) throw bad(entry, "sections [[species]], one for each kind of bodies");
    if (known_section(entry.key)) throw bad(entry, fmt::format("a section [{}] with keys", entry.key));
    const auto nearest = nearest_name(key, known);
    const std::string name = one_line(entry.key, 60);
    const bool in_section = known_section(key.substr(0, key.find('.')));
    throw InputError(fmt::format("{}: unknown key {}{}; accepted: {}", entry.where, name,
                                 nearest ? fmt::format(", did you mean {}?", with_index(*nearest, index)) : "",
                                 keys_near(in_section ? key : nearest.value_or(""))));
  }
}

void check_may_change(const std::vector<std::string>& overrides) {
  std::vector<std::string_view> accepted;
  for (const Key& key : keys()) {
    if (key.may_change) accepted.push_back(key.name);
  }
  for (const std::string& assignment : overrides) {
    const std::string name = assignment.substr(0, assignment.find_first_of(" ="));
    if (std::find(accepted.begin(), accepted.end(), name) != accepted.end()) continue;
    throw InputError(fmt::format("--set {}: a run that has begun keeps this key; accepted: {}",
                                 one_line(assignment, 60), fmt::join(accepted, ", ")));
  }
}

void read_entry(const Entry& entry, std::string_view name, const Target& target) {
  if (const auto refusal = key_called(name).rule.take(entry.value, target))
    throw bad(entry, refusal->accepted, refusal->why);
}

void read_key(const TomlDocument& document, std::string_view name, const Target& target) {
  if (const Entry* entry = document.find(name)) read_entry(*entry, name, target);
}

void read_section(const TomlDocument& document, const std::string& section, const Target& target) {
  const std::string known = without_index(section);
  for (const Key& key : keys()) {
    if (section_of(key.name) != known || last_part(key.name) == last_part(kInertiaKey)) continue;
    const Entry* entry = document.find(full_name(section, last_part(key.name)));
    if (entry != nullptr) read_entry(*entry, key.name, target);
  }
}

InputError missing(const std::string& where, const std::string& name, const Target& target, std::string_view of) {
  // A value of no kind is refused by every rule.
  const auto refusal = key_called(without_index(name)).rule.take(Value(), target);
  return InputError(fmt::format("{}: {}{} is missing; accepted: {}", where, name, of, refusal->accepted));
}

std::vector<PlacedKey> keys_of(const Config& config) {
  std::vector<PlacedKey> list;
  for (const std::string_view section : sections()) {
    const bool several = section == "species";
    if (section == "start" && !config.start_file) continue;
    if ((several && !config.mixture) || (section == "shape" && config.mixture)) continue;
    for (std::size_t k = 0; k < (several ? config.species.size() : 1); ++k) {
      const Place place{config, &config.species[k]};
      for (const Key& key : keys()) {
        if (section_of(key.name) != section || (key.written != nullptr && !key.written(place))) continue;
        list.push_back({full_name(several ? species_name(k) : section, last_part(key.name)), &key, place});
      }
    }
  }
  return list;
}

std::optional<Difference> difference(const Config& here, const Config& there) {
  const auto text = [](const PlacedKey& key) { return one_line(key.key->rule.text(key.place), kShownLength); };
  const auto with_value = [&](const Config& config) {
    std::vector<PlacedKey> list;
    for (const PlacedKey& key : keys_of(config)) {
      if (!key.key->may_change && !text(key).empty()) list.push_back(key);
    }
    return list;
  };
  const std::vector<PlacedKey> mine = with_value(here);
  const std::vector<PlacedKey> theirs = with_value(there);
  for (const PlacedKey& key : mine) {
    const PlacedKey* other = find_by(theirs, &PlacedKey::name, key.name);
    if (other == nullptr) return Difference{key.name, text(key), "nothing"};
    if (!key.key->rule.same(key.place, other->place)) return Difference{key.name, text(key), text(*other)};
  }
  for (const PlacedKey& key : theirs) {
    if (find_by(mine, &PlacedKey::name, key.name) == nullptr) return Difference{key.name, "nothing", text(key)};
  }
  return std::nullopt;
}

}  // namespace hardbody
