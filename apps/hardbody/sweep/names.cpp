#include "sweep/names.h"

#include "base/errors.h"
#include "base/suggest.h"
#include "config/keys.h"
#include "io/text_file.h"
#include "sweep/grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

namespace hardbody {
namespace {

/// Returns the key of the config that a key of a grid stands for: grid[2].start.file is start.file.
std::string_view config_key(std::string_view key) {
  const std::size_t dot = key.find('.');
  return dot != std::string_view::npos && is_grid(key.substr(0, dot)) ? key.substr(dot + 1) : key;
}

}  // namespace

bool is_grid(std::string_view section) {
  return section == "grid" || section.starts_with("grid[");
}

bool in_grid(const Entry& entry) {
  return is_grid(std::string_view(entry.key).substr(0, entry.key.find('.')));
}

bool is_own_key(const Entry& entry) {
  return entry.key == "base" || entry.key == "chain" || entry.key == kReplicasKey || entry.key == "grid";
}

void check_own_names(const TomlDocument& document) {
  constexpr std::array<std::string_view, 5> kTop = {kSeedKey, "base", "chain", kReplicasKey, "grid"};
  for (const Entry& entry : document.entries) {
    const bool at_the_top = entry.key.find('.') == std::string::npos;
    if (!at_the_top || std::find(kTop.begin(), kTop.end(), entry.key) != kTop.end()) continue;
    const auto nearest = nearest_name(entry.key, kTop);
    throw InputError(fmt::format("{}: unknown key {}{}; accepted at the top of a sweep: seed, base, chain, replicas",
                                 entry.where, one_line(entry.key, 60),
                                 nearest ? fmt::format(", did you mean {}?", *nearest) : ""));
  }
  constexpr std::array<std::string_view, 1> kGrid = {"grid"};
  for (const Section& section : document.sections) {
    const std::string name = section.name.substr(0, section.name.find('['));
    if (name == "grid" || !nearest_name(name, kGrid)) continue;
    throw InputError(
        fmt::format("{}: unknown section [{}], did you mean [grid]?; accepted: [grid] and the sections of "
                    "a config",
                    section.where, one_line(name, 40)));
  }
}

TomlDocument with_files(TomlDocument document, const Renaming& renamed) {
  for (Entry& entry : document.entries) {
    const std::string key(config_key(entry.key));
    if (names_file(key)) entry.value = hardbody::with_files(std::move(entry.value), renamed);
    bool changed = false;
    for (Member& member : entry.value.members) {
      if (!names_file(key + "." + member.key)) continue;
      member.value = hardbody::with_files(std::move(member.value), renamed);
      changed = true;
    }
    if (changed) entry.value.shown = toml_text(entry.value);
  }
  return document;
}

bool is_range(const Value& value) {
  return value.kind == Value::Kind::table && value.find("from") != nullptr;
}

std::vector<Entry> flattened(const TomlDocument& document, const Entry& entry) {
  if (entry.value.kind != Value::Kind::table || is_range(entry.value)) return {entry};
  std::vector<Entry> entries;
  for (const Member& member : entry.value.members) {
    entries.push_back({entry.key + "." + member.key, document.where(member.line), member.line, member.value});
  }
  return entries;
}

std::vector<Entry> flattened(const TomlDocument& document) {
  std::vector<Entry> entries;
  for (const Entry& entry : document.entries) {
    for (Entry& one : flattened(document, entry)) entries.push_back(std::move(one));
  }
  return entries;
}

}  // namespace hardbody
