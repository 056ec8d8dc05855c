#include "sweep/table.h"

#include "base/find.h"
#include "config/keys.h"
#include "io/toml_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace hardbody {
namespace {

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

/// Returns the names of the observables of all records, in the order of their first occurrence.
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
  return std::find(keys.begin(), keys.end(), kSeedKey) != keys.end();
}

/// Columns that only one of the tables has.
struct Kind {
  bool pooled = false;    ///< rows are pooled replicas: column `replicas`
  bool replicas = false;  ///< rows are replicas: column `replica`, and each has its own seed
};

std::string header(const std::vector<std::string>& keys, const std::vector<std::string>& names, Kind kind) {
  std::string text;
  for (const std::string& key : keys) text += field(key) + ",";
  if (!has_seed(keys)) text += "seed,";
  if (kind.replicas) text += "replica,";
  text += "equilibration_time,production_time";
  for (const std::string& name : names) text += fmt::format(",{},{}_error", name, name);
  return text + fmt::format(",equilibrated,{}status,message,wall_seconds,collisions_per_second\n",
                            kind.pooled ? "replicas," : "");
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
  for (const auto& [names, reason] : reasons) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", names, reason);
  }
  return text;
}

std::string message_of(const PointRecord& record) {
  if (!record.message.empty()) return record.message;
  const std::string missing = record.results ? missing_text(record.results->observables) : "";
  return record.note + (record.note.empty() || missing.empty() ? "" : "; ") + missing;
}

/// Returns the fields of the keys, each with a comma.
std::string key_fields(const PointRecord& record, const std::vector<std::string>& keys, Kind kind) {
  std::string text;
  for (const std::string& key : keys) {
    const bool own_seed = kind.replicas && key == kSeedKey;
    text += (own_seed ? fmt::format("{}", record.seed) : field(record.point.find(key)->value)) + ",";
  }
  if (!has_seed(keys)) text += fmt::format("{},", record.seed);
  return text;
}

std::string row(const PointRecord& record, std::size_t number, const std::vector<std::string>& keys,
                const std::vector<std::string>& names, Kind kind) {
  std::string text = key_fields(record, keys, kind);
  if (kind.replicas) text += fmt::format("{},", record.replica);
  const PointResults results = record.results.value_or(PointResults{});
  text += fmt::format("{},{}", results.equilibration_time, results.production_time);
  for (const std::string& name : names) {
    const PrintedEstimate* known = find_by(results.observables, &PrintedEstimate::name, name);
    text += fmt::format(",{},{}", known != nullptr ? known->value : "", known != nullptr ? known->error : "");
  }
  const char* equilibrated = !record.results ? "" : results.equilibrated ? "true" : "false";
  const std::string replicas = kind.pooled ? fmt::format("{},", number) : std::string();
  return text + fmt::format(",{},{}{},{},{},{}\n", equilibrated, replicas, to_string(record.status),
                            field(message_of(record)), results.wall_seconds, results.collisions_per_second);
}

std::string number_field(double x) {
  return std::isfinite(x) ? fmt::format("{}", x) : "";
}

std::string agreement_row(const PooledValue& agreement) {
  const ed::Pooled& p = agreement.pooled;
  std::string text = fmt::format("{},{},{},{},{},{},{},{},{}", agreement.observable, number_field(p.mean.value),
                                 number_field(p.mean.error), number_field(p.within), number_field(p.between), p.number,
                                 number_field(p.chi_square), p.degrees_of_freedom, number_field(p.probability));
  return text + (p.outlier ? fmt::format(",{},{:.3g}\n", p.outlier->replica, p.outlier->errors) : ",,\n");
}

}  // namespace

std::string sweep_csv(const std::vector<PooledPoint>& points, int replicas) {
  std::vector<PointRecord> records;
  records.reserve(points.size());
  for (const PooledPoint& point : points) records.push_back(point.record);
  const Kind kind{.pooled = replicas > 1};
  const std::vector<std::string> keys = keys_of(records);
  const std::vector<std::string> names = observable_names(records);
  std::string text = header(keys, names, kind);
  for (const PooledPoint& point : points) text += row(point.record, point.number, keys, names, kind);
  return text;
}

std::string replicas_csv(const std::vector<PointRecord>& records) {
  const Kind kind{.replicas = true};
  const std::vector<std::string> keys = keys_of(records);
  const std::vector<std::string> names = observable_names(records);
  std::string text = header(keys, names, kind);
  for (const PointRecord& record : records) text += row(record, 1, keys, names, kind);
  return text;
}

std::string agreement_csv(const std::vector<PooledPoint>& points) {
  std::vector<PointRecord> records;
  records.reserve(points.size());
  for (const PooledPoint& point : points) records.push_back(point.record);
  const std::vector<std::string> keys = keys_of(records);
  std::string text;
  for (const std::string& key : keys) text += field(key) + ",";
  if (!has_seed(keys)) text += "seed,";
  text +=
      "observable,value,error,error_within,error_between,replicas,chi_square,degrees_of_freedom,probability,outlier,"
      "outlier_errors\n";
  for (const PooledPoint& point : points) {
    const std::string begin = key_fields(point.record, keys, {});
    for (const PooledValue& agreement : point.agreement) text += begin + agreement_row(agreement);
  }
  return text;
}

}  // namespace hardbody
