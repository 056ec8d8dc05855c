#include "report/sweep.h"

#include "base/console.h"
#include "base/errors.h"
#include "base/find.h"
#include "base/number_text.h"
#include "io/csv_table.h"
#include "io/json_member.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "registry/key_names.h"
#include "registry/observables.h"
#include "sweep/table.h"

#include <ed/replicas.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestState = std::size_t{1} << 20;

/// Maximum number of bodies shown of all points together.
constexpr std::size_t kMostBodiesOfPoints = 300'000;

/// First of the columns of the table that are neither keys nor observables; the keys come before it.
constexpr const char* kFirstResult = "equilibration_time";
constexpr const char* kErrorSuffix = "_error";

using TableRow = std::vector<std::string>;

CsvTable read_table(const fs::path& path) {
  CsvTable table = read_csv(path);
  if (table.find(kFirstResult) && !table.rows.empty()) return table;
  throw InputError(fmt::format("{}: has no points; accepted: the table of a sweep", path.string()));
}

/// Returns a field of a row; empty if there is no such column.
std::string field_of(const CsvTable& table, const TableRow& row, std::string_view column) {
  const std::optional<std::size_t> place = table.find(column);
  return place ? row[*place] : std::string();
}

double number_of(const std::string& field) {
  return finite_number(field).value_or(std::numeric_limits<double>::quiet_NaN());
}

/// Returns the columns of swept keys, which come first; the seed only if it is not the same everywhere.
std::vector<std::size_t> key_columns(const CsvTable& table) {
  std::vector<std::size_t> columns;
  const std::size_t end = *table.find(kFirstResult);
  for (std::size_t k = 0; k < end; ++k) {
    const auto same = [&](const TableRow& row) { return row[k] == table.rows[0][k]; };
    if (table.header[k] == "seed" && std::all_of(table.rows.begin(), table.rows.end(), same)) continue;
    columns.push_back(k);
  }
  return columns;
}

/// Returns the columns that have a column of errors.
std::vector<std::size_t> observable_columns(const CsvTable& table) {
  std::vector<std::size_t> columns;
  for (std::size_t k = *table.find(kFirstResult); k < table.header.size(); ++k) {
    if (table.find(table.header[k] + kErrorSuffix)) columns.push_back(k);
  }
  return columns;
}

/// Returns the value of a key as a text that is the same for the table's field and for state.json's member.
std::string comparable(std::string text) {
  if (const std::optional<double> value = finite_number(text)) return fmt::format("{:.15g}", *value);
  std::erase(text, ' ');
  return text;
}

std::string comparable(const nlohmann::json& json) {
  if (json.is_number()) return fmt::format("{:.15g}", json.get<double>());
  return comparable(json.is_string() ? json.get<std::string>() : json.dump());
}

std::string signature_part(const std::string& key, const std::string& value) {
  return key + "=" + value + "\n";
}

/// Returns the directories of points by their keys.
std::map<std::string, std::string> directories_of(const fs::path& sweep) {
  std::map<std::string, std::string> directories;
  for (const fs::directory_entry& entry : fs::directory_iterator(sweep)) {
    const fs::path state = entry.path() / kPointStateFile;
    if (!fs::exists(state)) continue;
    try {
      const nlohmann::json json = parse_json(read_file(state, kLongestState));
      if (!json.is_object() || !json.contains("keys") || !json["keys"].is_object()) throw JsonError("has no keys");
      if (json.contains("replica") && json["replica"] != 0) continue;
      std::string signature;  // sorted, as the library keeps objects
      for (const auto& [key, value] : json["keys"].items()) signature += signature_part(key, comparable(value));
      directories[signature] = entry.path().filename().string();
    } catch (const JsonError& error) {
      throw InputError(fmt::format("{}: {}; accepted: the state of a sweep's point", state.string(), error.what()));
    }
  }
  return directories;
}

/// Returns the directory of a row, in which every column before the results may be a key.
std::string directory_of(const CsvTable& table, const TableRow& row,
                         const std::map<std::string, std::string>& directories) {
  for (const bool with_seed : {true, false}) {
    std::map<std::string, std::string> sorted;
    for (std::size_t k = 0; k < *table.find(kFirstResult); ++k) {
      if (with_seed || table.header[k] != "seed") sorted[table.header[k]] = comparable(row[k]);
    }
    std::string signature;
    for (const auto& [key, value] : sorted) signature += signature_part(key, value);
    const auto found = directories.find(signature);
    if (found != directories.end()) return found->second;
  }
  return "";
}

/// Gives missing values the reason from the point's run. The message of a completed point contains nothing else.
void add_reasons(SweepPointReport& point, const std::vector<Headline>& observables, bool pooled) {
  if (point.status != "done") return;
  // Of replicas the message also says where they disagree.
  if (!pooled) point.message.clear();
  for (std::size_t k = 0; k < observables.size(); ++k) {
    const Headline* own = find_by(point.run->headlines, &Headline::key, observables[k].key);
    if (own != nullptr) point.values[k].missing = own->missing;
  }
}

/// Reads the run of a point, or sets a message why it cannot be shown.
void read_run(SweepPointReport& point, const fs::path& sweep, std::size_t& bodies) {
  const fs::path directory = sweep / point.directory;
  if (point.directory.empty() || !fs::exists(directory / kConfigFile)) return;
  try {
    point.run = read_run_report(directory, bodies < kMostBodiesOfPoints ? WithView::yes : WithView::no);
    if (point.run->view) bodies += point.run->view->shape_of.size() * point.run->view->frames.size();
  } catch (const InputError& error) {
    point.message += (point.message.empty() ? "" : "; ") + one_line(error.what());
  }
}

/// Returns whether every point has a run, of spheres only.
bool all_spheres(const SweepReport& sweep) {
  return std::all_of(sweep.points.begin(), sweep.points.end(),
                     [](const SweepPointReport& point) { return point.run && !point.run->oriented; });
}

void leave_out_orientation(SweepReport& sweep) {
  for (std::size_t k = sweep.observables.size(); k-- > 0;) {
    const Observable* known = find_observable(sweep.observables[k].key);
    if (known == nullptr || !known->of_orientation) continue;
    const auto at = static_cast<std::ptrdiff_t>(k);
    sweep.observables.erase(sweep.observables.begin() + at);
    for (SweepPointReport& point : sweep.points) point.values.erase(point.values.begin() + at);
  }
}

/// Gives the points the values of their replicas.
void add_replicas(SweepReport& sweep, const CsvTable& pooled, const std::vector<std::size_t>& observables) {
  if (!fs::exists(sweep.path / kReplicasTableFile)) return;
  const CsvTable table = read_csv(sweep.path / kReplicasTableFile);
  if (table.rows.empty() || table.rows.size() % sweep.points.size() != 0) return;
  const std::size_t each = table.rows.size() / sweep.points.size();
  for (std::size_t o = 0; o < observables.size(); ++o) {
    const std::optional<std::size_t> column = table.find(pooled.header[observables[o]]);
    for (std::size_t k = 0; column && k < table.rows.size(); ++k) {
      if (field_of(table, table.rows[k], "status") != "done") continue;
      const double value = number_of(table.rows[k][*column]);
      if (std::isfinite(value)) sweep.points[k / each].values[o].replicas.push_back(value);
    }
  }
}

/// Pools the points that differ in their seed alone.
void add_groups(SweepReport& sweep) {
  std::map<std::string, std::size_t> of_keys;
  std::vector<std::vector<const SweepPointReport*>> members;
  for (SweepPointReport& point : sweep.points) {
    std::string signature;
    for (std::size_t k = 0; k < sweep.keys.size(); ++k) {
      if (sweep.keys[k] != "seed") signature += signature_part(sweep.keys[k], point.keys[k]);
    }
    const auto [found, is_new] = of_keys.try_emplace(signature, members.size());
    if (is_new) members.emplace_back();
    point.group = found->second;
    members[point.group].push_back(&point);
  }
  for (const auto& points : members) {
    std::vector<Measured>& values = sweep.groups.emplace_back();
    for (std::size_t o = 0; o < sweep.observables.size(); ++o) values.push_back(pooled_over(points, o));
  }
}

std::string title_of(const std::vector<std::string>& keys, std::size_t points) {
  if (keys.empty() && points == 1) return "Replicas of one state point";
  std::string names;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    names += (k == 0 ? "" : k + 1 == keys.size() ? " and " : ", ") + key_words(keys[k]);
  }
  return fmt::format("Sweep of {}: {} state points", names.empty() ? "one point" : names, points);
}

}  // namespace

double value_at(const SweepPointReport& point, std::size_t observable) {
  return point.status == "failed" ? std::numeric_limits<double>::quiet_NaN() : point.values[observable].value;
}

Measured pooled_over(const std::vector<const SweepPointReport*>& points, std::size_t observable) {
  std::vector<ed::Estimate> values;
  Measured result{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  bool all = true;  // points that are not done yet do not count
  for (const SweepPointReport* point : points) {
    const Measured& measured = point->values[observable];
    if (result.missing.empty()) result.missing = measured.missing;
    if (!std::isfinite(value_at(*point, observable))) {
      all = all && point->status != "done";
      continue;
    }
    values.push_back({measured.value, measured.error});
    result.replicas.push_back(measured.value);
  }
  if (points.size() == 1) result.replicas = points.front()->values[observable].replicas;
  if (values.empty() || !all) return result;
  const ed::Pooled pooled = ed::pool(values);
  result.value = pooled.mean.value;
  result.error = pooled.mean.error;
  result.missing.clear();
  return result;
}

bool is_sweep(const fs::path& directory) {
  return fs::exists(directory / kSweepTableFile) && !fs::exists(directory / kConfigFile);
}

SweepReport read_sweep_report(const fs::path& directory) {
  const CsvTable table = read_table(directory / kSweepTableFile);
  const std::map<std::string, std::string> directories = directories_of(directory);
  const std::vector<std::size_t> keys = key_columns(table);
  const std::vector<std::size_t> observables = observable_columns(table);
  SweepReport sweep;
  sweep.path = directory;
  sweep.name = name_of(directory);
  for (const std::size_t k : keys) sweep.keys.push_back(table.header[k]);
  for (const std::size_t k : observables) sweep.observables.push_back(headline_named(table.header[k]));
  sweep.title = title_of(sweep.keys, table.rows.size());
  std::size_t bodies = 0;
  for (const TableRow& row : table.rows) {
    console().poll();
    SweepPointReport point;
    for (const std::size_t k : keys) point.keys.push_back(row[k]);
    for (const std::size_t k : observables) {
      point.values.push_back({number_of(row[k]), number_of(field_of(table, row, table.header[k] + kErrorSuffix))});
    }
    point.status = field_of(table, row, "status");
    point.message = field_of(table, row, "message");
    point.equilibrated = field_of(table, row, "equilibrated");
    point.directory = directory_of(table, row, directories);
    read_run(point, directory, bodies);
    if (point.run) add_reasons(point, sweep.observables, table.find("replicas").has_value());
    sweep.points.push_back(std::move(point));
  }
  add_replicas(sweep, table, observables);
  if (all_spheres(sweep)) leave_out_orientation(sweep);
  add_groups(sweep);
  return sweep;
}

}  // namespace hardbody
