#include "sweep/replicas.h"

#include "base/find.h"
#include "base/number_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace hardbody {
namespace {

using Replicas = std::span<const PointRecord>;

/// Probability that the message of a point names a disagreement though its replicas agree.
constexpr double kFalseAlarm = 0.01;

std::string shortest(double x) {
  return std::isfinite(x) ? fmt::format("{}", x) : "";
}

double number_of(const std::string& text) {
  return finite_number(text).value_or(std::numeric_limits<double>::quiet_NaN());
}

std::vector<const PointRecord*> finished(Replicas replicas) {
  std::vector<const PointRecord*> list;
  for (const PointRecord& record : replicas) {
    if (record.status == PointStatus::done && record.results) list.push_back(&record);
  }
  return list;
}

/// Returns the weighted mean of a printed number, which is that number itself where all agree.
std::string mean_of(const std::vector<const PointRecord*>& runs, std::string PointResults::*member) {
  const std::string& first = runs.front()->results.value().*member;
  double sum = 0;
  bool same = true;
  for (const PointRecord* run : runs) {
    const std::string& text = run->results.value().*member;
    same = same && text == first;
    sum += number_of(text);
  }
  return same ? first : shortest(sum / static_cast<double>(runs.size()));
}

std::vector<double> lengths_of(const std::vector<const PointRecord*>& runs) {
  std::vector<double> lengths;
  lengths.reserve(runs.size());
  for (const PointRecord* run : runs) lengths.push_back(number_of(run->results->production_time));
  const bool positive = std::all_of(lengths.begin(), lengths.end(), [](double t) { return t > 0; });
  return positive ? lengths : std::vector<double>();
}

/// Returns the names of all, in the order of their first occurrence.
std::vector<std::string> names_of(const std::vector<const PointRecord*>& runs) {
  std::vector<std::string> names;
  for (const PointRecord* run : runs) {
    for (const PrintedEstimate& e : run->results->observables) {
      if (std::find(names.begin(), names.end(), e.name) == names.end()) names.push_back(e.name);
    }
  }
  return names;
}

/// Returns whether an observable depends on the first wave number of F_self.
bool is_of_wave_number(const std::string& name) {
  return name == "tau_F" || name == "beta_F" || name == "t_F_1overe";
}

bool same_wave_number(const std::vector<const PointRecord*>& runs) {
  return std::all_of(runs.begin(), runs.end(), [&](const PointRecord* run) {
    return run->results->wave_number == runs.front()->results->wave_number;
  });
}

/// Pools an observable. A mean over the replicas that happen to have a value would be biased: one without hides it.
PrintedEstimate pooled_estimate(const std::vector<const PointRecord*>& runs, const std::string& name,
                                const std::vector<double>& weights, std::vector<PooledValue>& agreement) {
  std::vector<ed::Estimate> values;
  std::string reason;
  for (const PointRecord* run : runs) {
    const PrintedEstimate* own = find_by(run->results->observables, &PrintedEstimate::name, name);
    if (own != nullptr && own->of_direction) {
      return {name, "", "", "every replica has a director of its own, see replicas.csv", true};
    }
    const double value = own != nullptr ? number_of(own->value) : std::numeric_limits<double>::quiet_NaN();
    if (std::isfinite(value)) {
      values.push_back({value, number_of(own->error)});
    } else if (reason.empty()) {
      reason = own == nullptr || own->missing.empty() ? "no value" : own->missing;
    }
  }
  if (is_of_wave_number(name) && !same_wave_number(runs)) {
    return {name, "", "", "every replica has wave numbers of its own: production.wave_numbers sets them"};
  }
  const std::size_t without = runs.size() - values.size();
  if (without == runs.size()) return {name, "", "", reason};
  if (without > 0) return {name, "", "", fmt::format("{} of {} replicas: {}", without, runs.size(), reason)};
  ed::Pooled pooled = ed::pool(values, weights);
  if (pooled.outlier) pooled.outlier->replica = static_cast<std::size_t>(runs[pooled.outlier->replica]->replica);
  agreement.push_back({name, pooled});
  return {name, shortest(pooled.mean.value), shortest(pooled.mean.error)};
}

PointResults pooled_results(const std::vector<const PointRecord*>& runs, std::vector<PooledValue>& agreement) {
  PointResults results;
  results.equilibration_time = mean_of(runs, &PointResults::equilibration_time);
  results.production_time = mean_of(runs, &PointResults::production_time);
  results.collisions_per_second = mean_of(runs, &PointResults::collisions_per_second);
  double wall = 0;
  for (const PointRecord* run : runs) wall += number_of(run->results->wall_seconds);
  results.wall_seconds = shortest(wall);
  const auto all = [&](bool PointResults::*member) {
    return std::all_of(runs.begin(), runs.end(), [&](const PointRecord* r) { return r->results.value().*member; });
  };
  results.equilibrated = all(&PointResults::equilibrated);
  results.sound = all(&PointResults::sound);
  const std::vector<double> weights = lengths_of(runs);
  for (const std::string& name : names_of(runs)) {
    results.observables.push_back(pooled_estimate(runs, name, weights, agreement));
  }
  return results;
}

PointStatus status_of(Replicas replicas) {
  for (const PointStatus status :
       {PointStatus::failed, PointStatus::running, PointStatus::stopped, PointStatus::pending}) {
    if (find_by(replicas, &PointRecord::status, status) != nullptr) return status;
  }
  return PointStatus::done;
}

/// Returns the first failure, and how many there are.
std::string failures(Replicas replicas) {
  const PointRecord* first = find_by(replicas, &PointRecord::status, PointStatus::failed);
  const auto number = std::count_if(replicas.begin(), replicas.end(),
                                    [](const PointRecord& r) { return r.status == PointStatus::failed; });
  return fmt::format("replica {}: {}{}", first->replica, first->message,
                     number > 1 ? fmt::format("; {} of {} replicas failed", number, replicas.size()) : "");
}

/// Returns two replicas with the same results to the last digit.
std::optional<std::pair<int, int>> same_runs(const std::vector<const PointRecord*>& runs) {
  for (std::size_t a = 0; a < runs.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const auto& values = runs[a]->results->observables;
      const bool any = std::any_of(values.begin(), values.end(), [](const auto& e) { return !e.value.empty(); });
      if (any && values == runs[b]->results->observables) return std::pair(runs[b]->replica, runs[a]->replica);
    }
  }
  return std::nullopt;
}

/// Names the observables in which replicas disagree.
std::string disagreements(const std::vector<PooledValue>& agreement) {
  const double limit = std::min(ed::kDisagreement, kFalseAlarm / static_cast<double>(agreement.size()));
  std::string text;
  for (const auto& [observable, pooled] : agreement) {
    if (!(pooled.probability < limit)) continue;
    const std::string who = pooled.outlier ? fmt::format("replica {} is {:.1f} errors from the others",
                                                         pooled.outlier->replica, pooled.outlier->errors)
                                           : std::string("replicas disagree");
    text += fmt::format("{}{}: {}, chi-square {:.1f} of {}", text.empty() ? "" : "; ", observable, who,
                        pooled.chi_square, pooled.degrees_of_freedom);
  }
  return text;
}

}  // namespace

std::string replica_directory(std::string_view point, int replica) {
  if (point.empty()) return fmt::format("replica={}", replica);
  return replica == 0 ? std::string(point) : fmt::format("{}_replica={}", point, replica);
}

PooledPoint pooled_point(std::span<const PointRecord> replicas) {
  PooledPoint row;
  row.record = replicas.front();
  const std::vector<const PointRecord*> runs = finished(replicas);
  row.number = runs.size();
  if (replicas.size() == 1) return row;
  row.record.status = status_of(replicas);
  row.record.message = row.record.status == PointStatus::failed ? failures(replicas) : "";
  row.record.results.reset();
  if (runs.empty()) return row;
  if (const auto same = same_runs(runs)) {
    row.record.status = PointStatus::failed;
    row.record.message = fmt::format(
        "replicas {} and {} are the same run: nothing in it depends on the seed; accepted: replicas = 1, or "
        "a start that draws something",
        same->first, same->second);
    return row;
  }
  row.record.results = pooled_results(runs, row.agreement);
  if (runs.size() < 2) row.agreement.clear();
  row.record.note = disagreements(row.agreement);
  return row;
}

}  // namespace hardbody
