#include "sweep/overrides.h"

#include "base/errors.h"
#include "base/find.h"
#include "config/keys.h"
#include "io/text_file.h"
#include "sweep/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string_view>
#include <utility>

namespace hardbody {
namespace {

/// Line of keys that stand behind all others of their grid.
constexpr int kLastLine = std::numeric_limits<int>::max();

std::string_view grid_of(const Entry& entry) {
  return std::string_view(entry.key).substr(0, entry.key.find('.'));
}

/// Makes the grid that an override needs, if the file has none; refuses a grid that the file does not have.
void find_grid(TomlDocument& document, const Entry& entry) {
  const std::string name(grid_of(entry));
  if (find_by(document.sections, &Section::name, name) != nullptr) return;
  const auto number = std::count_if(document.sections.begin(), document.sections.end(),
                                    [](const Section& section) { return is_grid(section.name); });
  if (number == 0 && name == "grid") {
    document.sections.push_back({name, false, entry.where, kLastLine});
    return;
  }
  const bool several = number > 0 && document.sections.back().name != "grid";
  throw InputError(fmt::format("{}: there is no {} in the file; accepted: {}", entry.where, one_line(name, 40),
                               several ? fmt::format("grid[1] to grid[{}]", number) : std::string("grid")));
}

/// Writes tables of a grid out, so that each key is an entry.
void flatten_grids(TomlDocument& document) {
  std::vector<Entry> entries;
  for (const Entry& entry : document.entries) {
    if (!in_grid(entry)) {
      entries.push_back(entry);
      continue;
    }
    for (Entry& one : flattened(document, entry)) entries.push_back(std::move(one));
  }
  document.entries = std::move(entries);
}

}  // namespace

SweepOverrides read_overrides(const std::vector<std::string>& texts, const std::string& name) {
  TomlDocument given = read_toml("", name, texts);
  check_own_names(given);
  given = with_files(std::move(given), [](const std::filesystem::path& file) { return absolute_path(file); });
  SweepOverrides overrides;
  for (Entry& entry : given.entries) {
    if (entry.key == "base" && entry.value.kind == Value::Kind::text && !entry.value.text.empty()) {
      entry.value.text = absolute_path(entry.value.text).string();
    }
    (in_grid(entry) || is_own_key(entry) ? overrides.own : overrides.config).push_back(std::move(entry));
  }
  return overrides;
}

void lay_over_own(TomlDocument& document, std::vector<Entry> own) {
  if (own.empty()) return;
  flatten_grids(document);
  for (Entry& entry : own) {
    if (in_grid(entry) && entry.key.find('.') != std::string::npos) {
      find_grid(document, entry);
      const Entry* before = document.find(entry.key);
      entry.line = before != nullptr ? before->line : kLastLine;
    }
    document.set(std::move(entry));
  }
}

void lay_over_config(TomlDocument& base, std::vector<Entry> config, const std::vector<Grid>& grids) {
  for (Entry& entry : config) {
    for (const Grid& grid : grids) {
      for (const ZippedAxes& group : grid.groups) {
        if (find_by(group, &Axis::key, entry.key) == nullptr) continue;
        throw InputError(fmt::format("{}: {} is a key of the grid; accepted: grid.{}, or a key that is in no grid",
                                     entry.where, entry.key, entry.key));
      }
    }
    const std::string section(section_of(entry.key));
    const bool there = section.empty() || find_by(base.sections, &Section::name, section) != nullptr;
    if (!there && section == without_index(section)) base.sections.push_back({section, false, entry.where, 0});
    base.set(std::move(entry));
  }
}

}  // namespace hardbody
