#pragma once

/// The grid of a sweep: which values its keys take together.

#include "io/toml_document.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// A key of the config and the values it takes, in their order.
struct Axis {
  std::string key;    ///< as --set takes it
  std::string where;  ///< file:line
  std::vector<Value> values;
};

/// Axes that are walked together, value by value; most have only one.
using ZippedAxes = std::vector<Axis>;

/// Every combination of its groups' values; the last group varies fastest.
struct Grid {
  std::string where;  ///< file:line of its head
  std::vector<ZippedAxes> groups;
  std::filesystem::path directory;  ///< what names of files are relative to
};

/// A key and the value that it has at a state point.
struct Setting {
  std::string key;
  std::string where;  ///< of the axis
  Value value;        ///< as the grid has it
  Value told;         ///< as a run takes it, wherever that is started: names of files are absolute

  /// key=told, as --set takes it.
  std::string assignment() const;
};

/// A state point of a sweep.
struct SweepPoint {
  std::string name;  ///< of its directory: the last parts of the keys and their values
  std::vector<Setting> settings;

  const Setting* find(std::string_view key) const;
};

/// Whether the key (of a config, not [grid]) names a file or directory that a run reads.
bool names_file(std::string_view key);

/// The same value with another name for every relative name of a file in it.
Value with_files(Value value, const std::function<std::filesystem::path(const std::filesystem::path&)>& renamed);

/// Such a name as seen from everywhere.
std::filesystem::path absolute_from(const std::filesystem::path& directory, const std::filesystem::path& name);

/// All points, grid after grid. Throws InputError for lists of unequal lengths walked together, grids with different
/// keys, a point that is there twice, and more points than kMostPoints.
std::vector<SweepPoint> expand(const std::vector<Grid>& grids);

/// For each point the one that comes before it along that key: the next smaller value, all other keys being the same.
/// Throws InputError for a value that is no number.
std::vector<std::optional<std::size_t>> predecessors(const std::vector<SweepPoint>& points, std::string_view key);

inline constexpr std::size_t kMostPoints = 100'000;

/// from, from + step, .. up to `to`, which belongs to it if a step falls on it; rounded to the digits that anybody
/// writes. Empty if the step leads nowhere.
std::vector<double> stepped(double from, double to, double step);

enum class Spacing { linear, log };
/// `count` values, from and to included; at least 2.
std::vector<double> spaced(double from, double to, std::size_t count, Spacing spacing);

}  // namespace hardbody
