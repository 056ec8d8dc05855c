#include "sweep/tasks/cost.h"

#include "base/number_text.h"
#include "config/keys.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

namespace hardbody {
namespace {

/// Number of finished runs that a prediction is made of.
constexpr std::size_t kNearest = 6;
/// Number of finished runs that are compared, spread over all: plans of 10^5 runs would else take minutes.
constexpr std::size_t kMostCompared = 1000;
/// Distance within which runs count the same.
constexpr double kNear = 0.02;

std::optional<double> seconds_of(const PointRecord& record) {
  const std::optional<double> seconds = record.results ? finite_number(record.results->wall_seconds) : std::nullopt;
  return seconds && *seconds > 0 ? seconds : std::nullopt;
}

double memory_of(const PointRecord& record) {
  return finite_number(record.results->peak_memory_bytes).value_or(0);
}

}  // namespace

Costs::Costs(const std::vector<PointRecord>& records) : records_(records) {
  const std::size_t keys = records.empty() ? 0 : records.front().point.settings.size();
  places_.assign(records.size(), std::vector<double>(keys, std::numeric_limits<double>::quiet_NaN()));
  for (std::size_t j = 0; j < keys; ++j) {
    const std::string& key = records.front().point.settings[j].key;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const PointRecord& record : records) {
      const Value& value = record.point.find(key)->value;
      if (!is_number(value)) continue;
      low = std::min(low, value.real);
      high = std::max(high, value.real);
    }
    for (std::size_t k = 0; k < records.size(); ++k) {
      const Value& value = records[k].point.find(key)->value;
      // A seed changes no cost.
      if (key == kSeedKey)
        places_[k][j] = 0;
      else if (is_number(value))
        places_[k][j] = high > low ? (value.real - low) / (high - low) : 0;
    }
  }
  for (std::size_t k = 0; k < records.size(); ++k) {
    const bool finished = records[k].status == PointStatus::done && records[k].cost && seconds_of(records[k]);
    if (finished) finished_.push_back(k);
  }
  if (finished_.size() <= kMostCompared) return;
  std::vector<std::size_t> some;
  some.reserve(kMostCompared);
  for (std::size_t k = 0; k < kMostCompared; ++k) some.push_back(finished_[k * finished_.size() / kMostCompared]);
  finished_ = std::move(some);
}

double Costs::distance(std::size_t a, std::size_t b) const {
  double squares = 0;
  for (std::size_t j = 0; j < places_[a].size(); ++j) {
    const double apart = places_[a][j] - places_[b][j];
    if (std::isfinite(apart)) {
      squares += apart * apart;
    } else {
      const std::string& key = records_.front().point.settings[j].key;
      squares += same_value(records_[a].point.find(key)->value, records_[b].point.find(key)->value) ? 0 : 1;
    }
  }
  return std::sqrt(squares);
}

Cost Costs::predicted(std::size_t k, bool by_other_points) const {
  const Cost by_config = *records_[k].cost;
  std::vector<std::pair<double, std::size_t>> near;
  for (const std::size_t f : finished_) {
    if (by_other_points && records_[f].point.name == records_[k].point.name) continue;
    near.emplace_back(distance(k, f), f);
  }
  if (near.empty()) return by_config;
  const std::size_t number = std::min(kNearest, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(number), near.end());
  double weights = 0;
  double logarithms = 0;
  double memory = 0;
  for (std::size_t n = 0; n < number; ++n) {
    const auto [apart, f] = near[n];
    const double weight = 1 / (apart * apart + kNear * kNear);
    weights += weight;
    logarithms += weight * std::log(*seconds_of(records_[f]) / records_[f].cost->seconds);
    memory = std::max(memory, memory_of(records_[f]) / records_[f].cost->memory);
  }
  return {by_config.seconds * std::exp(logarithms / weights),
          memory > 0 ? memory * by_config.memory : by_config.memory};
}

std::optional<Cost> Costs::of(std::size_t k) const {
  return records_[k].cost ? std::optional(predicted(k, false)) : std::nullopt;
}

double Costs::error() const {
  std::set<std::string> points;
  double squares = 0;
  for (const std::size_t f : finished_) {
    points.insert(records_[f].point.name);
    const double off = std::log(predicted(f, true).seconds / *seconds_of(records_[f]));
    squares += off * off;
  }
  if (points.size() < 3) return kCostModelFactor;
  return std::exp(std::sqrt(squares / static_cast<double>(finished_.size())));
}

}  // namespace hardbody
