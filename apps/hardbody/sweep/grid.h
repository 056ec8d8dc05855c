#pragma once

/// Grid of a sweep: the combinations of values that its keys take.

#include "io/toml_document.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Key of the config and its values, in their order.
struct Axis {
  std::string key;    ///< key in the form of --set
  std::string where;  ///< file:line
  std::vector<Value> values;
};

/// Axes whose values change together, one after the other; most groups have only one axis.
using ZippedAxes = std::vector<Axis>;

/// All combinations of its groups' values; the last group varies fastest.
struct Grid {
  std::string where;  ///< file:line of the grid's head
  std::vector<ZippedAxes> groups;
  std::filesystem::path directory;  ///< directory to which names of files are relative
  bool single = false;              ///< whether it stands for the single point of a sweep without a grid
};

/// Key with its value at a state point.
struct Setting {
  std::string key;
  std::string where;  ///< file:line of the axis
  Value value;        ///< value in the grid
  Value told;         ///< value passed to a run, wherever that is started: names of files are absolute

  /// Returns key=told, in the form of --set.
  std::string assignment() const;
};

/// State point of a sweep.
struct SweepPoint {
  std::string name;  ///< last parts of the keys and their values, for its directory; empty without a grid
  std::vector<Setting> settings;

  const Setting* find(std::string_view key) const;
};

/// Returns a text that distinguishes points. The last digits of a number are ignored as rounding; integers (seeds) have
/// none. `without`: a key that is ignored.
std::string identity(const SweepPoint& point, std::string_view without = {});

/// Returns whether the key (of a config, not [grid]) names a file or directory that a run reads.
bool names_file(std::string_view key);

/// Returns the value with every relative name of a file in it replaced.
Value with_files(Value value, const std::function<std::filesystem::path(const std::filesystem::path&)>& renamed);

/// Returns the absolute form of a name that is relative to `directory`.
std::filesystem::path absolute_from(const std::filesystem::path& directory, const std::filesystem::path& name);

/// Returns all points, grid after grid. Throws InputError for lists of unequal lengths that change together, grids with
/// different keys, duplicate points, and more points than kMostPoints.
std::vector<SweepPoint> expand(const std::vector<Grid>& grids);

/// Returns for each point its predecessor along this key: the point with the next smaller value, all other keys being
/// the same. Throws InputError for a value that is not a number.
std::vector<std::optional<std::size_t>> predecessors(const std::vector<SweepPoint>& points, std::string_view key);

inline constexpr std::size_t kMostPoints = 100'000;

/// Returns from, from + step, .. up to `to`, which is included if a step falls on it; rounded to a plausible number of
/// digits. Empty if the step leads away from `to`.
std::vector<double> stepped(double from, double to, double step);

enum class Spacing { linear, log };
/// Returns `count` values, from and to included; at least 2.
std::vector<double> spaced(double from, double to, std::size_t count, Spacing spacing);

}  // namespace hardbody
