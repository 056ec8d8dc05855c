#include "sweep/results.h"

#include "base/find.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "registry/observables.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace hardbody {
namespace {

using Json = nlohmann::ordered_json;

/// Returns a number as printed in the summary; empty for null.
std::string printed(const Json& json) {
  return json.is_null() ? "" : json.dump();
}

/// Returns the observables that are numbers: no director, no tensors, no lists by axis.
std::vector<PrintedEstimate> scalars_of(const Json& observables) {
  std::vector<PrintedEstimate> list;
  for (const auto& [name, estimate] : observables.items()) {
    const Observable* known = find_observable(name);
    const bool scalar = estimate.is_object() && estimate.contains("value") && estimate.contains("error") &&
                        !estimate["value"].is_array() && (known == nullptr || is_number(*known));
    if (!scalar) continue;
    list.push_back({name, printed(estimate["value"]), printed(estimate["error"]), estimate.value("missing", "")});
  }
  return list;
}

PointResults results_of(const Json& summary) {
  PointResults results;
  results.equilibration_time = printed(summary.at("time").at("equilibration"));
  results.production_time = printed(summary.at("time").at("production"));
  results.observables = scalars_of(summary.at("observables"));
  results.equilibrated = summary.at("equilibrated").get<bool>();
  results.sound = summary.at("sound").get<bool>();
  results.wall_seconds = printed(summary.at("performance").at("total_wall_seconds"));
  results.collisions_per_second = printed(summary.at("performance").at("collisions_per_second"));
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

/// Returns a field of CSV: texts with commas, quotes or blanks at their ends are quoted.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string field(const Value& value) {
  if (value.kind == Value::Kind::text) return field(value.text);
  if (value.kind == Value::Kind::real) return fmt::format("{}", value.real);
  return field(toml_text(value));
}

/// Returns the names of all, in the order of their first occurrence.
std::vector<std::string> observable_names(const std::vector<PointRecord>& records) {
  std::vector<std::string> names;
  for (const PointRecord& record : records) {
    if (!record.results) continue;
    for (const PrintedEstimate& e : record.results->observables) {
      if (std::find(names.begin(), names.end(), e.name) == names.end()) names.push_back(e.name);
    }
  }
  return names;
}

/// Returns the keys in the order of the first grid.
std::vector<std::string> keys_of(const std::vector<PointRecord>& records) {
  std::vector<std::string> keys;
  if (records.empty()) return keys;
  for (const Setting& s : records[0].point.settings) keys.push_back(s.key);
  return keys;
}

bool has_seed(const std::vector<std::string>& keys) {
  return std::find(keys.begin(), keys.end(), "seed") != keys.end();
}

std::string header(const std::vector<std::string>& keys, const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& key : keys) text += field(key) + ",";
  if (!has_seed(keys)) text += "seed,";
  text += "equilibration_time,production_time";
  for (const std::string& name : names) text += fmt::format(",{},{}_error", name, name);
  return text + ",equilibrated,status,message,wall_seconds,collisions_per_second\n";
}

/// Returns "A: bodies have moved ..; B, C: ..": names with the same reason are listed together.
std::string missing_text(const std::vector<PrintedEstimate>& observables) {
  std::vector<std::pair<std::string, std::string>> reasons;  // names, reason
  for (const PrintedEstimate& e : observables) {
    if (e.missing.empty()) continue;
    const auto same = [&](const auto& r) { return r.second == e.missing; };
    const auto found = std::find_if(reasons.begin(), reasons.end(), same);
    if (found == reasons.end()) {
      reasons.emplace_back(e.name, e.missing);
    } else {
      found->first += ", " + e.name;
    }
  }
  std::string text;
  for (const auto& [names, reason] : reasons) text += (text.empty() ? "" : "; ") + names + ": " + reason;
  return text;
}

std::string row(const PointRecord& record, const std::vector<std::string>& keys,
                const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& key : keys) text += field(record.point.find(key)->value) + ",";
  if (!has_seed(keys)) text += fmt::format("{},", record.seed);
  const PointResults results = record.results.value_or(PointResults{});
  text += fmt::format("{},{}", results.equilibration_time, results.production_time);
  for (const std::string& name : names) {
    const PrintedEstimate* known = find_by(results.observables, &PrintedEstimate::name, name);
    text += fmt::format(",{},{}", known != nullptr ? known->value : "", known != nullptr ? known->error : "");
  }
  const std::string message = record.message.empty() ? missing_text(results.observables) : record.message;
  const char* equilibrated = !record.results ? "" : results.equilibrated ? "true" : "false";
  return text + fmt::format(",{},{},{},{},{}\n", equilibrated, to_string(record.status), field(message),
                            results.wall_seconds, results.collisions_per_second);
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

std::string state_json(const PointRecord& record) {
  Json json = {{"name", record.point.name}};
  json["keys"] = Json::object();
  for (const Setting& s : record.point.settings) json["keys"][s.key] = json_of(s.value);
  json["seed"] = record.seed;
  json["status"] = to_string(record.status);
  json["message"] = record.message;
  return json.dump(2) + "\n";
}

std::string sweep_csv(const std::vector<PointRecord>& records) {
  const std::vector<std::string> keys = keys_of(records);
  const std::vector<std::string> names = observable_names(records);
  std::string text = header(keys, names);
  for (const PointRecord& record : records) text += row(record, keys, names);
  return text;
}

}  // namespace hardbody
