#include "sweep/results.h"

#include "io/json_values.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "registry/observables.h"
#include "run/observables_json.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

namespace hardbody {
namespace {

using Json = nlohmann::ordered_json;

/// Returns a number as printed in the summary; empty for null.
std::string printed(const Json& json) {
  return json.is_null() ? "" : json.dump();
}

/// Returns the observables that are numbers, and the components of a director: no tensors, no lists by axis.
std::vector<PrintedEstimate> scalars_of(const Json& observables) {
  std::vector<PrintedEstimate> list;
  for (const auto& [name, estimate] : observables.items()) {
    const Observable* known = find_observable(name);
    const bool scalar = estimate.is_object() && estimate.contains("value") && estimate.contains("error") &&
                        !estimate["value"].is_array() && (known == nullptr || is_number(*known));
    if (!scalar || lacks_order(estimate)) continue;
    list.push_back({name, printed(estimate["value"]), printed(estimate["error"]), estimate.value("missing", "")});
  }
  const std::optional<ed::Director> director = director_in(observables);
  for (std::size_t k = 0; director && k < kBodyAxes.size(); ++k) {
    const ed::Estimate n = component_of(*director, static_cast<int>(k));
    list.push_back({fmt::format("director_{}", kBodyAxes[k]), printed(number_json(n.value)),
                    printed(number_json(n.error)), "", true});
  }
  return list;
}

PointResults results_of(const Json& summary) {
  PointResults results;
  results.equilibration_time = printed(summary.at("time").at("equilibration"));
  results.production_time = printed(summary.at("time").at("production"));
  results.observables = scalars_of(summary.at("observables"));
  const Json wave_numbers = summary.value("wave_numbers", Json::array());
  results.wave_number = wave_numbers.is_array() && !wave_numbers.empty() ? printed(wave_numbers[0]) : "";
  results.equilibrated = summary.at("equilibrated").get<bool>();
  results.sound = summary.at("sound").get<bool>();
  results.wall_seconds = printed(summary.at("performance").at("total_wall_seconds"));
  results.collisions_per_second = printed(summary.at("performance").at("collisions_per_second"));
  const Json& performance = summary.at("performance");
  results.peak_memory_bytes =
      performance.contains("peak_memory_bytes") ? printed(performance["peak_memory_bytes"]) : "";
  return results;
}

Json json_of(const Value& value) {
  switch (value.kind) {
    case Value::Kind::boolean:
      return value.integer != 0;
    case Value::Kind::integer:
      return value.integer;
    case Value::Kind::real:
      return value.real;
    case Value::Kind::array: {
      Json list = Json::array();
      for (const Value& item : value.items) list.push_back(json_of(item));
      return list;
    }
    default:
      return value.text;
  }
}

}  // namespace

const char* to_string(PointStatus status) {
  return std::array{"pending", "running", "stopped", "done", "failed"}[static_cast<std::size_t>(status)];
}

std::optional<PointResults> finished_results(const std::filesystem::path& directory) {
  const std::filesystem::path file = directory / kSummaryFile;
  if (!std::filesystem::exists(file)) return std::nullopt;
  try {
    const Json summary = Json::parse(read_file(file, kLongestSummary));
    if (summary.at("interrupted").get<bool>() || !summary.at("stalled").is_null()) return std::nullopt;
    return results_of(summary);
  } catch (const Json::exception&) {
    const std::string name = directory.filename().string();
    throw std::runtime_error(
        fmt::format("{}/{} was not written by a run; accepted: delete the directory {}, and the same command "
                    "runs the point again",
                    name, kSummaryFile, name));
  }
}

bool is_over(const PointRecord& record) {
  return record.status == PointStatus::done || (record.status == PointStatus::failed && record.for_good);
}

std::string state_json(const PointRecord& record, int replicas) {
  Json json = {{"name", record.directory}};
  json["keys"] = Json::object();
  for (const Setting& s : record.point.settings) json["keys"][s.key] = json_of(s.value);
  json["seed"] = record.seed;
  if (replicas > 1) json["replica"] = record.replica;
  json["status"] = to_string(record.status);
  if (record.status == PointStatus::failed) json["for_good"] = record.for_good;
  json["message"] = record.message;
  return json.dump(2) + "\n";
}

}  // namespace hardbody
