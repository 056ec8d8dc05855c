#include "sweep/plan.h"

#include "base/errors.h"
#include "config/config.h"
#include "config/keys.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "sweep/directory.h"
#include "sweep/grid.h"
#include "sweep/replicas.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

namespace hardbody {
namespace {

void check_number(const SweepFile& sweep, std::size_t points) {
  if (points * static_cast<std::size_t>(sweep.replicas) <= kMostPoints) return;
  throw InputError(fmt::format("{}: makes more than {} runs, {} points of {} replicas; accepted: fewer",
                               sweep.grids.front().where, kMostPoints, points, sweep.replicas));
}

/// Returns the seed of a point, of which its replicas have their own.
std::int64_t seed_of(const SweepFile& sweep, const SweepPoint& point) {
  if (const Setting* setting = point.find(kSeedKey)) return setting->value.integer;
  const Entry* entry = sweep.base.find(kSeedKey);
  return entry != nullptr ? entry->value.integer : PointRecord{}.seed;
}

}  // namespace

std::vector<PointRecord> listed(const SweepFile& sweep) {
  std::vector<SweepPoint> points = expand(sweep.grids);
  check_number(sweep, points.size());
  const auto replicas = static_cast<std::size_t>(sweep.replicas);
  std::vector<std::optional<std::size_t>> before(points.size());
  if (sweep.chain) before = predecessors(points, *sweep.chain);
  std::vector<PointRecord> records;
  records.reserve(points.size() * replicas);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::int64_t own_seed = seed_of(sweep, points[k]);
    for (std::size_t r = 0; r < replicas; ++r) {
      PointRecord& record = records.emplace_back();
      record.replica = static_cast<int>(r);
      record.seed = ed::replica_seed(own_seed, record.replica);
      record.directory = sweep.replicas > 1 ? replica_directory(points[k].name, record.replica) : points[k].name;
      if (before[k]) record.starts_from = *before[k] * replicas + r;
      record.point = r + 1 < replicas ? points[k] : std::move(points[k]);
    }
  }
  return records;
}

void judge(const SweepFile& sweep, PointRecord& record) {
  try {
    record.cost = cost_by_config(read_config(document_of(sweep, record.point)));
  } catch (const InputError& error) {
    record.message = error.what();
    record.status = PointStatus::failed;
    record.for_good = true;
  }
}

std::vector<PointRecord> planned(const SweepFile& sweep) {
  std::vector<PointRecord> records = listed(sweep);
  const auto replicas = static_cast<std::size_t>(sweep.replicas);
  for (std::size_t k = 0; k < records.size(); ++k) {
    PointRecord& first = records[k - k % replicas];
    if (k % replicas == 0) {
      judge(sweep, first);
      continue;
    }
    records[k].cost = first.cost;
    records[k].message = first.message;
    records[k].status = first.status;
    records[k].for_good = first.for_good;
  }
  const auto failed = [](const PointRecord& record) { return record.status == PointStatus::failed; };
  // No point can be run: an error of the sweep, not of its points.
  if (std::all_of(records.begin(), records.end(), failed)) throw InputError(records.front().message);
  return records;
}

void take_up(PointRecord& record, const std::filesystem::path& directory) {
  if (record.status == PointStatus::failed) return;
  try {
    record.results = finished_results(directory / record.directory);
  } catch (const std::exception& error) {
    record.status = PointStatus::failed;
    record.for_good = true;
    record.message = error.what();
    return;
  }
  if (!record.results) return;
  record.status = record.results->sound ? PointStatus::done : PointStatus::failed;
  record.for_good = !record.results->sound;
  record.message = record.results->sound ? "" : "NOT SOUND, see log.txt";
}

void take_up_state(PointRecord& record, const std::filesystem::path& directory) {
  constexpr std::size_t kLongestState = std::size_t{1} << 20;
  const std::filesystem::path file = directory / record.directory / kPointStateFile;
  if (!std::filesystem::exists(file)) return;
  const nlohmann::json state = nlohmann::json::parse(read_file(file, kLongestState), nullptr, false);
  if (!state.is_object()) return;
  for (const PointStatus status : {PointStatus::running, PointStatus::stopped, PointStatus::failed}) {
    if (state.value("status", "") != to_string(status)) continue;
    record.status = status;
    record.message = state.value("message", "");
    record.for_good = state.value("for_good", false);
  }
}

std::vector<std::string> arguments_of(const std::vector<PointRecord>& records, std::size_t k,
                                      const std::filesystem::path& directory) {
  const PointRecord& record = records[k];
  if (std::filesystem::exists(directory / record.directory / kConfigFile)) return {"resume", record.directory};
  std::vector<std::string> arguments = {"run", kBaseFile, "--out", record.directory};
  const auto set = [&](const std::string& assignment) {
    arguments.emplace_back("--set");
    arguments.push_back(assignment);
  };
  for (const Setting& s : record.point.settings) {
    if (record.replica == 0 || s.key != kSeedKey) set(s.assignment());
  }
  if (record.replica > 0) set(fmt::format("{}={}", kSeedKey, record.seed));
  if (record.starts_from) set(std::string(kStartFromKey) + "=" + records[*record.starts_from].directory);
  return arguments;
}

}  // namespace hardbody
