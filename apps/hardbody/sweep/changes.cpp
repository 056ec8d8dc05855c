#include "sweep/changes.h"

#include "base/errors.h"
#include "base/find.h"
#include "sweep/grid.h"
#include "sweep/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

/// Key whose value has changed; "not there" if it is missing.
struct ChangedKey {
  std::string key;
  std::string where;  ///< file:line of the new value, or the file
  std::string before;
  std::string now;
};

/// Returns the first changed key; nullopt if all values are the same.
std::optional<ChangedKey> changed_key(const std::vector<Entry>& then, const std::vector<Entry>& today,
                                      const std::string& file) {
  constexpr const char* kMissing = "not there";
  for (const Entry& entry : today) {
    const Entry* other = find_by(then, &Entry::key, entry.key);
    if (other == nullptr) return ChangedKey{entry.key, entry.where, kMissing, entry.value.shown};
    if (!same_value(other->value, entry.value)) {
      return ChangedKey{entry.key, entry.where, other->value.shown, entry.value.shown};
    }
  }
  for (const Entry& entry : then) {
    if (find_by(today, &Entry::key, entry.key) == nullptr)
      return ChangedKey{entry.key, file, entry.value.shown, kMissing};
  }
  return std::nullopt;
}

/// Returns the keys with absolute names of files, without those of grids if they are not wanted.
std::vector<Entry> keys_of(const SweepFile& sweep, bool with_grids) {
  std::vector<Entry> entries = flattened(absolute_files(sweep.whole, sweep.directory));
  std::erase_if(entries, [](const Entry& entry) { return entry.key == kReplicasKey; });
  if (!with_grids) std::erase_if(entries, in_grid);
  return entries;
}

std::vector<std::string> grid_keys(const SweepFile& sweep) {
  std::vector<std::string> keys;
  for (const ZippedAxes& group : sweep.grids.front().groups) {
    for (const Axis& axis : group) keys.push_back(axis.key);
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

using PointPlaces = std::map<std::string, std::size_t>;  // of points, by their identity

PointPlaces places_of(const std::vector<SweepPoint>& points) {
  PointPlaces places;
  for (std::size_t k = 0; k < points.size(); ++k) places.emplace(identity(points[k]), k);
  return places;
}

/// Checks the points that were there: they are kept, with their names and the points that they start from.
void check_points(const SweepFile& held, const SweepFile& now, const fs::path& directory) {
  const std::vector<SweepPoint> before = expand(held.grids);
  const std::vector<SweepPoint> points = expand(now.grids);
  const PointPlaces places = places_of(points);
  const std::string& where = now.grids.front().where;
  std::vector<std::optional<std::size_t>> starts_before(before.size());
  std::vector<std::optional<std::size_t>> starts(points.size());
  if (now.chain) {
    starts_before = predecessors(before, *now.chain);
    starts = predecessors(points, *now.chain);
  }
  for (std::size_t k = 0; k < before.size(); ++k) {
    const auto found = places.find(identity(before[k]));
    if (found == places.end()) {
      throw InputError(
          fmt::format("{}: lacks the point {} of the sweep that {} holds; accepted: a grid with all of "
                      "its points, or another directory",
                      where, before[k].name, directory.string()));
    }
    const SweepPoint& same = points[found->second];
    if (same.name != before[k].name) {
      throw InputError(
          fmt::format("{}: the directory {} of a point would become {}; accepted: new points behind those "
                      "that are there, or another directory",
                      where, before[k].name, same.name));
    }
    const std::string origin = starts_before[k] ? before[*starts_before[k]].name : "nothing";
    const std::string origin_now = starts[found->second] ? points[*starts[found->second]].name : "nothing";
    if (origin_now != origin) {
      throw InputError(
          fmt::format("{}: {} would start from {}, in the sweep that {} holds it starts from {}; "
                      "accepted: new points at the upper end of chains, or another directory",
                      where, same.name, origin_now, directory.string(), origin));
    }
  }
}

}  // namespace

void check_continues(const SweepFile& held, const SweepFile& now, const fs::path& directory) {
  if (now.replicas < held.replicas) {
    const Entry* entry = now.whole.find(kReplicasKey);
    throw InputError(fmt::format(
        "{}: replicas is {}, but {} in the sweep that {} holds; accepted: as many or more, or another directory",
        entry != nullptr ? entry->where : now.whole.name, now.replicas, held.replicas, directory.string()));
  }
  if (!changed_key(keys_of(held, true), keys_of(now, true), now.whole.name)) return;
  const bool other_keys = grid_keys(held) != grid_keys(now);
  const std::optional<ChangedKey> changed =
      changed_key(keys_of(held, other_keys), keys_of(now, other_keys), now.whole.name);
  if (changed) {
    throw InputError(
        fmt::format("{}: {} is {}, but {} in the sweep that {} holds; accepted: that sweep, also with more values in "
                    "its grid, or another directory",
                    changed->where, changed->key, changed->now, changed->before, directory.string()));
  }
  check_points(held, now, directory);
}

}  // namespace hardbody
