#include "sweep/grid.h"

#include "base/errors.h"
#include "base/find.h"
#include "base/suggest.h"
#include "config/keys.h"
#include "io/text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

/// Longer names of directories are replaced by numbers.
constexpr std::size_t kLongestName = 120;

/// Maximum length of a value with names of files in messages.
constexpr std::size_t kLongestShown = 300;

/// Number of digits to which steps are rounded: 0.1 + 2 * 0.1 is 0.3. Numbers that agree in them are equal.
constexpr int kDigits = 12;

/// Fraction of a step by which the last step may miss `to`.
constexpr double kStepSlack = 1e-6;

double rounded(double x) {
  return std::stod(fmt::format("{:.{}g}", x, kDigits));
}

bool is_numeric(const Value& value) {
  return value.kind == Value::Kind::integer || value.kind == Value::Kind::real;
}

/// Returns the part of a directory's name for a value: letters, digits, and characters that are not special in shells.
std::string name_part(const Value& value) {
  if (value.kind == Value::Kind::real) return fmt::format("{}", value.real);
  std::string text = value.kind == Value::Kind::text ? value.text : toml_text(value);
  if (value.kind == Value::Kind::array) {
    text.clear();
    for (const Value& item : value.items) {
      if (!text.empty()) text += 'x';
      text += name_part(item);
    }
  }
  for (char& c : text) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       std::string_view("+-.").find(c) != std::string_view::npos;
    if (!plain) c = '-';
  }
  return text;
}

/// Returns the last parts of the keys, or the whole keys if two would be the same.
std::vector<std::string> short_keys(const std::vector<Setting>& settings) {
  std::map<std::string_view, int> times;
  for (const Setting& s : settings) ++times[last_part(s.key)];
  std::vector<std::string> names;
  names.reserve(settings.size());
  for (const Setting& s : settings) names.emplace_back(times[last_part(s.key)] == 1 ? last_part(s.key) : s.key);
  return names;
}

std::string point_name(const std::vector<Setting>& settings) {
  const std::vector<std::string> keys = short_keys(settings);
  std::string name;
  for (std::size_t k = 0; k < settings.size(); ++k) {
    name += fmt::format("{}{}={}", k == 0 ? "" : "_", keys[k], name_part(settings[k].value));
  }
  return name;
}

/// Returns "system.packing_fraction = 0.3, shape.aspect_ratio = 2".
std::string description(const SweepPoint& point) {
  std::string text;
  for (const Setting& s : point.settings) {
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", s.key, s.value.shown);
  }
  return text;
}

/// Overload for a value.
std::string identity(const Value& value) {
  std::string number = fmt::format("{:.{}g}", value.real, kDigits);
  if (value.kind == Value::Kind::real || (is_numeric(value) && number == fmt::format("{}", value.integer)))
    return number;
  if (value.kind != Value::Kind::array) return toml_text(value);
  std::string text = "[";
  for (const Value& item : value.items) text += identity(item) + ",";
  return text + "]";
}

void check_lengths(const ZippedAxes& group) {
  for (const Axis& axis : group) {
    if (axis.values.size() == group[0].values.size()) continue;
    throw InputError(
        fmt::format("{}: {} has {} values and {} has {}; accepted: lists of equal length for keys that "
                    "zip combines",
                    axis.where, axis.key, axis.values.size(), group[0].key, group[0].values.size()));
  }
}

std::set<std::string> keys_of(const Grid& grid) {
  std::set<std::string> keys;
  for (const ZippedAxes& group : grid.groups) {
    for (const Axis& axis : group) keys.insert(axis.key);
  }
  return keys;
}

/// Throws for grids with different keys: their points could be equal without being noticed, and would not fit into one
/// table.
void check_keys(const std::vector<Grid>& grids) {
  if (grids[0].single) return;
  const std::set<std::string> first = keys_of(grids[0]);
  for (const Grid& grid : grids) {
    const std::set<std::string> keys = keys_of(grid);
    if (keys.empty()) {
      throw InputError(fmt::format("{}: the grid has no keys; accepted: section.key = [values]", grid.where));
    }
    if (keys == first) continue;
    std::vector<std::string> differing;
    std::set_symmetric_difference(keys.begin(), keys.end(), first.begin(), first.end(), std::back_inserter(differing));
    throw InputError(
        fmt::format("{}: {} is a key of one grid and not of another; accepted: the same keys in every "
                    "[[grid]], if necessary with a single value",
                    grid.where, differing[0]));
  }
}

std::size_t number_of_points(const Grid& grid) {
  std::size_t number = 1;
  for (const ZippedAxes& group : grid.groups) {
    check_lengths(group);
    number *= group[0].values.size();
    if (number <= kMostPoints) continue;
    throw InputError(fmt::format("{}: has more than {} points; accepted: fewer", grid.where, kMostPoints));
  }
  return number;
}

/// Returns a point; the last group's value changes with every point.
SweepPoint point_of(const Grid& grid, std::size_t index) {
  SweepPoint point;
  for (std::size_t g = grid.groups.size(); g-- > 0;) {
    const ZippedAxes& group = grid.groups[g];
    const std::size_t at = index % group[0].values.size();
    index /= group[0].values.size();
    for (std::size_t k = group.size(); k-- > 0;) {
      const Axis& axis = group[k];
      Setting setting{axis.key, axis.where, axis.values[at], axis.values[at]};
      if (names_file(axis.key)) {
        setting.told =
            with_files(setting.value, [&](const fs::path& name) { return absolute_from(grid.directory, name); });
      }
      point.settings.push_back(std::move(setting));
    }
  }
  std::reverse(point.settings.begin(), point.settings.end());
  return point;
}

/// Replaces names that are too long, or the same for two points, by numbers.
void name_points(std::vector<SweepPoint>& points) {
  std::map<std::string, int> times;
  for (SweepPoint& point : points) {
    point.name = point_name(point.settings);
    ++times[point.name];
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    std::string& name = points[k].name;
    if (name.size() > kLongestName || times[name] > 1) name = fmt::format("point_{:05}", k + 1);
  }
}

}  // namespace

std::string identity(const SweepPoint& point, std::string_view without) {
  std::map<std::string, std::string> of_key;
  for (const Setting& s : point.settings) {
    if (s.key != without) of_key[s.key] = identity(s.told);
  }
  std::string text;
  for (const auto& [key, value] : of_key) text += fmt::format("{}={}\n", key, value);
  return text;
}

std::string Setting::assignment() const {
  return fmt::format("{}={}", key, toml_text(told));
}

bool names_file(std::string_view key) {
  return key == kStartFileKey || key == kStartFromKey;
}

Value with_files(Value value, const std::function<fs::path(const fs::path&)>& renamed) {
  const fs::path file = value.text;
  // An empty name is refused by the run.
  if (value.kind == Value::Kind::text && !file.empty() && file.is_relative()) value.text = renamed(file).string();
  for (Value& item : value.items) item = with_files(std::move(item), renamed);
  value.shown = one_line(toml_text(value), kLongestShown);
  return value;
}

fs::path absolute_from(const fs::path& directory, const fs::path& name) {
  return absolute_path(directory / name);
}

const Setting* SweepPoint::find(std::string_view key) const {
  return find_by(settings, &Setting::key, key);
}

std::vector<SweepPoint> expand(const std::vector<Grid>& grids) {
  check_keys(grids);
  std::vector<SweepPoint> points;
  std::map<std::string, std::string> seen;  // grid that contains the point
  for (const Grid& grid : grids) {
    const std::size_t number = number_of_points(grid);
    if (points.size() + number > kMostPoints) {
      throw InputError(fmt::format("{}: makes more than {} points; accepted: fewer", grid.where, kMostPoints));
    }
    for (std::size_t k = 0; k < number; ++k) {
      SweepPoint point = point_of(grid, k);
      const auto [other, is_new] = seen.try_emplace(identity(point), grid.where);
      if (!is_new) {
        throw InputError(fmt::format("{}: the point {} occurs twice{}; accepted: every point once", grid.where,
                                     description(point),
                                     other->second == grid.where ? "" : fmt::format(", also in {}", other->second)));
      }
      points.push_back(std::move(point));
    }
  }
  name_points(points);
  return points;
}

std::vector<std::optional<std::size_t>> predecessors(const std::vector<SweepPoint>& points, std::string_view key) {
  std::map<std::string, std::map<double, std::size_t>> chains;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Setting* setting = points[k].find(key);
    if (!is_numeric(setting->value)) {
      throw InputError(fmt::format("{}: {} is {}; accepted: numbers for the key of the chain", setting->where, key,
                                   setting->value.shown));
    }
    chains[identity(points[k], key)][setting->value.real] = k;
  }
  std::vector<std::optional<std::size_t>> before(points.size());
  for (const auto& [others, chain] : chains) {
    std::optional<std::size_t> last;
    for (const auto& [value, k] : chain) {
      before[k] = last;
      last = k;
    }
  }
  return before;
}

std::vector<double> stepped(double from, double to, double step) {
  const double steps = (to - from) / step;
  std::vector<double> values;
  if (!(steps >= 0 && steps < static_cast<double>(kMostPoints))) return values;
  for (int k = 0; k <= static_cast<int>(std::floor(steps + kStepSlack)); ++k)
    values.push_back(rounded(from + k * step));
  return values;
}

std::vector<double> spaced(double from, double to, std::size_t count, Spacing spacing) {
  std::vector<double> values;
  for (std::size_t k = 0; k < count; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(count - 1);
    values.push_back(rounded(spacing == Spacing::log ? from * std::pow(to / from, share) : from + share * (to - from)));
  }
  values.back() = to;
  return values;
}

}  // namespace hardbody
