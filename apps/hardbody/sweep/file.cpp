#include "sweep/file.h"

#include "base/errors.h"
#include "base/find.h"
#include "config/keys.h"
#include "io/text_file.h"
#include "sweep/names.h"
#include "sweep/overrides.h"
#include "sweep/replicas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestSweepFile = 1 << 20;  ///< bytes
constexpr const char* kChainKey = kPackingKey;
constexpr const char* kZipKey = "zip";
constexpr const char* kValues =
    "a list of values, {from, to, step}, {from, to, count} or {from, to, count, spacing = \"log\"}";

// ---- The base config

bool is_of_config(const Entry& entry) {
  return !in_grid(entry) && !is_own_key(entry);
}

TomlDocument config_part(const TomlDocument& document) {
  TomlDocument base;
  base.name = document.name;
  base.lines = document.lines;
  std::copy_if(document.entries.begin(), document.entries.end(), std::back_inserter(base.entries), is_of_config);
  std::copy_if(document.sections.begin(), document.sections.end(), std::back_inserter(base.sections),
               [](const Section& s) { return !is_grid(s.name); });
  return base;
}

/// Returns the config in the file itself, or the one that `base` names; relative names of files are relative to
/// `directory`.
TomlDocument read_base(const TomlDocument& document, const fs::path& directory) {
  TomlDocument own = config_part(document);
  const Entry* base = document.find("base");
  if (base == nullptr) return own;
  if (base->value.kind != Value::Kind::text || base->value.text.empty()) throw bad(*base, "the name of a config");
  if (!own.entries.empty() || !own.sections.empty()) {
    const std::string& where = own.entries.empty() ? own.sections[0].where : own.entries[0].where;
    throw InputError(
        fmt::format("{}: cannot be combined with base = {}; accepted: the config's keys either here or in that file",
                    where, base->value.shown));
  }
  const fs::path named = base->value.text;
  const fs::path path = directory / named;
  return with_files(read_toml(read_file(path, kLongestSweepFile), path.string(), {}),
                    [&](const fs::path& file) { return named.parent_path() / file; });
}

// ---- The grids

Value number_value(double x, bool integer) {
  Value value;
  value.kind = integer ? Value::Kind::integer : Value::Kind::real;
  value.integer = integer ? static_cast<std::int64_t>(x) : 0;
  value.real = x;
  value.shown = toml_text(value);
  return value;
}

/// Returns a number of a range.
double member_number(const Entry& entry, const char* key) {
  const Member* member = entry.value.find(key);
  if (member == nullptr || !is_number(member->value)) throw bad(entry, kValues);
  return member->value.real;
}

bool is_integer(const Value& range, const char* key) {
  return range.find(key)->value.kind == Value::Kind::integer;
}

std::vector<double> counted(const Entry& entry, double from, double to) {
  const Member* spacing = entry.value.find("spacing");
  const bool log = spacing != nullptr && spacing->value.text == "log";
  if (spacing != nullptr && !log && spacing->value.text != "linear") {
    throw bad(entry, "spacing = \"linear\" or \"log\"");
  }
  if (log && !(from > 0 && to > 0)) throw bad(entry, "from and to above 0 with spacing = \"log\"");
  const Value& count = entry.value.find("count")->value;
  if (count.kind != Value::Kind::integer || count.integer < 2 || count.integer > std::int64_t{kMostPoints}) {
    throw bad(entry, fmt::format("a count from 2 to {}", kMostPoints));
  }
  return spaced(from, to, static_cast<std::size_t>(count.integer), log ? Spacing::log : Spacing::linear);
}

std::vector<Value> range_values(const Entry& entry) {
  constexpr std::array<std::string_view, 5> kKnown = {"from", "to", "step", "count", "spacing"};
  for (const Member& member : entry.value.members) {
    if (std::find(kKnown.begin(), kKnown.end(), member.key) == kKnown.end()) throw bad(entry, kValues);
  }
  const double from = member_number(entry, "from");
  const double to = member_number(entry, "to");
  const bool by_step = entry.value.find("step") != nullptr;
  if (by_step == (entry.value.find("count") != nullptr)) throw bad(entry, kValues);
  if (by_step && entry.value.find("spacing") != nullptr) throw bad(entry, kValues);
  const std::vector<double> numbers =
      by_step ? stepped(from, to, member_number(entry, "step")) : counted(entry, from, to);
  if (numbers.empty())
    throw bad(entry, fmt::format("a step that leads from `from` to `to` in at most {}", kMostPoints));
  const bool integers =
      by_step ? is_integer(entry.value, "from") && is_integer(entry.value, "step")
              : std::all_of(numbers.begin(), numbers.end(), [](double x) { return x == std::round(x); }) &&
                    is_integer(entry.value, "from");
  std::vector<Value> values;
  values.reserve(numbers.size());
  for (const double x : numbers) values.push_back(number_value(x, integers));
  return values;
}

std::vector<Value> axis_values(const Entry& entry) {
  if (is_range(entry.value)) return range_values(entry);
  if (entry.value.kind == Value::Kind::table || entry.value.kind == Value::Kind::other) throw bad(entry, kValues);
  if (entry.value.kind != Value::Kind::array) return {entry.value};
  if (entry.value.items.empty()) throw bad(entry, kValues);
  return entry.value.items;
}

std::vector<Entry> grid_entries(const TomlDocument& document, const std::string& section) {
  std::vector<Entry> entries;
  for (const Entry& entry : document.entries) {
    if (!entry.key.starts_with(section + ".")) continue;
    for (Entry& one : flattened(document, entry)) {
      one.key.erase(0, section.size() + 1);
      entries.push_back(std::move(one));
    }
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.line < b.line; });
  return entries;
}

/// Returns the lists of keys whose values change together.
std::vector<std::vector<std::string>> zipped_keys(const Entry& entry) {
  constexpr const char* kAccepted = "a list of keys of this grid, or a list of such lists";
  const auto keys_of = [&](const Value& list) {
    std::vector<std::string> keys;
    for (const Value& item : list.items) {
      if (item.kind != Value::Kind::text) throw bad(entry, kAccepted);
      keys.push_back(item.text);
    }
    if (keys.size() < 2) throw bad(entry, kAccepted);
    return keys;
  };
  if (entry.value.kind != Value::Kind::array || entry.value.items.empty()) throw bad(entry, kAccepted);
  if (entry.value.items[0].kind != Value::Kind::array) return {keys_of(entry.value)};
  std::vector<std::vector<std::string>> lists;
  for (const Value& list : entry.value.items) lists.push_back(keys_of(list));
  return lists;
}

/// Moves the axes of the other keys to that of the list's first.
void zip_axes(Grid& grid, const Entry& entry, const std::vector<std::string>& keys) {
  const auto group_of = [&](const std::string& key) {
    const auto found = std::find_if(grid.groups.begin(), grid.groups.end(),
                                    [&](const ZippedAxes& g) { return g.size() == 1 && g[0].key == key; });
    if (found != grid.groups.end()) return found;
    throw InputError(
        fmt::format("{}: zip names {}, which is no key of this grid or is in another list; accepted: each "
                    "of its keys in one list",
                    entry.where, one_line(key, 60)));
  };
  ZippedAxes together;
  for (const std::string& key : keys) together.push_back(group_of(key)->front());
  *group_of(keys[0]) = {together[0]};
  for (std::size_t k = 1; k < keys.size(); ++k) grid.groups.erase(group_of(keys[k]));
  group_of(keys[0])->assign(together.begin(), together.end());
}

Grid read_grid(const TomlDocument& document, const Section& section) {
  Grid grid;
  grid.where = section.where;
  std::optional<Entry> zip;
  for (const Entry& entry : grid_entries(document, section.name)) {
    if (entry.key == kZipKey) {
      zip = entry;
    } else {
      grid.groups.push_back({{entry.key, entry.where, axis_values(entry)}});
    }
  }
  if (!zip) return grid;
  for (const std::vector<std::string>& keys : zipped_keys(*zip)) zip_axes(grid, *zip, keys);
  return grid;
}

int read_replicas(const TomlDocument& document) {
  const Entry* entry = document.find(kReplicasKey);
  if (entry == nullptr) return 1;
  const bool good =
      entry->value.kind == Value::Kind::integer && entry->value.integer >= 1 && entry->value.integer <= kMostReplicas;
  if (!good) throw bad(*entry, fmt::format("an integer from 1 to {}", kMostReplicas));
  return static_cast<int>(entry->value.integer);
}

std::vector<Grid> read_grids(const TomlDocument& document, int replicas) {
  if (const Entry* entry = document.find("grid")) throw bad(*entry, "a section [grid] with keys");
  std::vector<Grid> grids;
  for (const Section& section : document.sections) {
    if (is_grid(section.name)) grids.push_back(read_grid(document, section));
  }
  if (grids.empty() && replicas > 1) {
    Grid point;
    point.where = document.name;
    point.single = true;
    grids.push_back(std::move(point));
  }
  if (grids.empty()) {
    throw InputError(
        fmt::format("{}: has no [grid]: hardbody run takes the config of one run; accepted: a sweep's config, as "
                    "hardbody init --template sweep writes it",
                    document.name));
  }
  return grids;
}

std::optional<std::string> read_chain(const TomlDocument& document, const std::vector<Grid>& grids) {
  const Entry* chain = document.find("chain");
  if (chain == nullptr) return std::nullopt;
  if (chain->value.kind != Value::Kind::text || chain->value.text != kChainKey) {
    throw bad(*chain, fmt::format("\"{}\", or no chain", kChainKey));
  }
  for (const Grid& grid : grids) {
    for (const ZippedAxes& group : grid.groups) {
      for (const Axis& axis : group) {
        if (axis.key != kChainKey) continue;
        if (group.size() == 1) return chain->value.text;
        throw bad(*chain, fmt::format("no chain along a key that zip combines with others ({})", axis.where));
      }
    }
  }
  throw bad(*chain, "a key of the grid");
}

/// Returns the base config together with the sweep's own part, without the name of the base's file.
TomlDocument merged(const TomlDocument& base, const TomlDocument& document) {
  TomlDocument whole = base;
  for (const Entry& entry : document.entries) {
    if (in_grid(entry) || entry.key == "chain" || entry.key == kReplicasKey) whole.entries.push_back(entry);
  }
  for (const Section& section : document.sections) {
    if (is_grid(section.name)) whole.sections.push_back(section);
  }
  return whole;
}

}  // namespace

SweepFile parse_sweep(std::string_view text, const std::string& name, const fs::path& directory,
                      const std::vector<std::string>& overrides, Lines lines) {
  TomlDocument document = read_toml(text, name, {}, lines);
  check_own_names(document);
  auto [own, config] = read_overrides(overrides, name);
  lay_over_own(document, std::move(own));
  SweepFile sweep;
  sweep.directory = directory;
  sweep.replicas = read_replicas(document);
  sweep.grids = read_grids(document, sweep.replicas);
  for (Grid& grid : sweep.grids) grid.directory = directory;
  TomlDocument base = read_base(document, directory);
  lay_over_config(base, std::move(config), sweep.grids);
  sweep.whole = merged(base, document);
  sweep.base = absolute_files(base, directory);
  sweep.chain = read_chain(document, sweep.grids);
  return sweep;
}

SweepFile read_sweep(const fs::path& path, const std::vector<std::string>& overrides) {
  return parse_sweep(read_file(path, kLongestSweepFile), path.string(), path.parent_path(), overrides);
}

TomlDocument moved(TomlDocument whole, const fs::path& from, const fs::path& to) {
  // After a link ".." is the parent of its target: directories are compared with links resolved.
  const fs::path target = fs::weakly_canonical(absolute_path(to));
  return with_files(std::move(whole), [&](const fs::path& name) {
    const fs::path file = absolute_from(from, name);
    return (fs::weakly_canonical(file.parent_path()) / file.filename()).lexically_relative(target);
  });
}

TomlDocument absolute_files(TomlDocument whole, const fs::path& directory) {
  return with_files(std::move(whole), [&](const fs::path& name) { return absolute_from(directory, name); });
}

TomlDocument document_of(const SweepFile& sweep, const SweepPoint& point) {
  TomlDocument document = sweep.base;
  for (const Setting& s : point.settings) document.set({s.key, s.where, 0, s.told});
  return document;
}

}  // namespace hardbody
