#include "sweep/file.h"

#include "base/errors.h"
#include "base/find.h"
#include "base/suggest.h"
#include "config/keys.h"
#include "io/text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
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

// ---- Names

bool is_grid(std::string_view section) {
  return section == "grid" || section.starts_with("grid[");
}

bool in_grid(const Entry& entry) {
  return is_grid(std::string_view(entry.key).substr(0, entry.key.find('.')));
}

bool is_own_key(const Entry& entry) {
  return entry.key == "base" || entry.key == "chain" || entry.key == "grid";
}

/// Checks keys at the top and sections that only a sweep has; all others are checked by the config.
void check_own_names(const TomlDocument& document) {
  constexpr std::array<std::string_view, 4> kTop = {kSeedKey, "base", "chain", "grid"};
  for (const Entry& entry : document.entries) {
    const bool at_the_top = entry.key.find('.') == std::string::npos;
    if (!at_the_top || std::find(kTop.begin(), kTop.end(), entry.key) != kTop.end()) continue;
    const auto nearest = nearest_name(entry.key, kTop);
    throw InputError(fmt::format("{}: unknown key {}{}; accepted at the top of a sweep: seed, base, chain", entry.where,
                                 one_line(entry.key, 60), nearest ? fmt::format(", did you mean {}?", *nearest) : ""));
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

// ---- Names of files

using Renaming = std::function<fs::path(const fs::path&)>;

/// Returns the key of the config that a key of a grid stands for: grid[2].start.file is start.file.
std::string_view config_key(std::string_view key) {
  const std::size_t dot = key.find('.');
  return dot != std::string_view::npos && is_grid(key.substr(0, dot)) ? key.substr(dot + 1) : key;
}

/// Renames the files of all keys that name files, those of [grid.start] too.
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

bool is_range(const Value& value) {
  return value.kind == Value::Kind::table && value.find("from") != nullptr;
}

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

/// Returns the entries with full names: shape.aspect_ratio = .. and [grid.shape] with aspect_ratio = .. are the same.
std::vector<Entry> flattened(const TomlDocument& document, const Entry& entry) {
  if (entry.value.kind != Value::Kind::table || is_range(entry.value)) return {entry};
  std::vector<Entry> entries;
  for (const Member& member : entry.value.members) {
    entries.push_back({entry.key + "." + member.key, document.where(member.line), member.line, member.value});
  }
  return entries;
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

std::vector<Grid> read_grids(const TomlDocument& document) {
  if (const Entry* entry = document.find("grid")) throw bad(*entry, "a section [grid] with keys");
  std::vector<Grid> grids;
  for (const Section& section : document.sections) {
    if (is_grid(section.name)) grids.push_back(read_grid(document, section));
  }
  if (grids.empty()) {
    throw InputError(
        fmt::format("{}: has no [grid]; accepted: a sweep's config, as hardbody init --template sweep "
                    "writes it",
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
    if (in_grid(entry) || entry.key == "chain") whole.entries.push_back(entry);
  }
  for (const Section& section : document.sections) {
    if (is_grid(section.name)) whole.sections.push_back(section);
  }
  return whole;
}

/// Returns the keys by their full names, including those of sections in a grid, [grid] shape.aspect_ratio.
std::vector<Entry> all_keys(const TomlDocument& document) {
  std::vector<Entry> entries;
  for (const Entry& entry : document.entries) {
    for (Entry& one : flattened(document, entry)) entries.push_back(std::move(one));
  }
  return entries;
}

}  // namespace

SweepFile parse_sweep(std::string_view text, const std::string& name, const fs::path& directory, Lines lines) {
  const TomlDocument document = read_toml(text, name, {}, lines);
  check_own_names(document);
  SweepFile sweep;
  sweep.directory = directory;
  sweep.grids = read_grids(document);
  for (Grid& grid : sweep.grids) grid.directory = directory;
  const TomlDocument base = read_base(document, directory);
  sweep.whole = merged(base, document);
  sweep.base = absolute_files(base, directory);
  sweep.chain = read_chain(document, sweep.grids);
  return sweep;
}

SweepFile read_sweep(const fs::path& path) {
  return parse_sweep(read_file(path, kLongestSweepFile), path.string(), path.parent_path());
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

std::optional<ChangedKey> changed_key(const TomlDocument& before, const TomlDocument& now) {
  constexpr const char* kMissing = "not there";
  const std::vector<Entry> then = all_keys(before);
  const std::vector<Entry> today = all_keys(now);
  for (const Entry& entry : today) {
    const Entry* other = find_by(then, &Entry::key, entry.key);
    if (other == nullptr) return ChangedKey{entry.key, entry.where, kMissing, entry.value.shown};
    if (!same_value(other->value, entry.value)) {
      return ChangedKey{entry.key, entry.where, other->value.shown, entry.value.shown};
    }
  }
  for (const Entry& entry : then) {
    if (find_by(today, &Entry::key, entry.key) == nullptr)
      return ChangedKey{entry.key, now.name, entry.value.shown, kMissing};
  }
  return std::nullopt;
}

}  // namespace hardbody
