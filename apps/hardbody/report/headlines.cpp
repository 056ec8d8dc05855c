#include "registry/observables.h"
#include "report/run.h"
#include "run/observables_json.h"
#include "run/table.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace hardbody {
namespace {

double number_in(const nlohmann::json& estimate, const char* key) {
  const nlohmann::json& number = member(estimate, key);
  return number.is_number() ? number.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

Headline headline(const Observable& observable, const nlohmann::json& estimate) {
  const nlohmann::json& missing = member(estimate, "missing");
  return {observable.key,
          observable.symbol,
          observable.name,
          report_unit(observable),
          observable.definition,
          number_in(estimate, "value"),
          number_in(estimate, "error"),
          missing.is_string() ? missing.get<std::string>() : std::string()};
}

ed::Estimate estimate_in(const nlohmann::json& estimate) {
  return {number_in(estimate, "value"), number_in(estimate, "error")};
}

/// Whether the three numbers of a list tell directions apart: only some have a value, or two are apart.
bool differ(const nlohmann::json& values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    const ed::Estimate a = estimate_in(values[k]);
    const ed::Estimate b = estimate_in(values[(k + 1) % values.size()]);
    if (std::isfinite(a.value) != std::isfinite(b.value) || are_apart(a, b)) return true;
  }
  return false;
}

/// Bodies without an axis of revolution have a list of three, as have the edges of the box.
void add_axes(std::vector<Headline>& list, const nlohmann::json& observables_of_run, bool oriented) {
  for (const Observable& observable : observables()) {
    if (!is_per_axis(observable) || (observable.of_orientation && !oriented)) continue;
    const auto values = observables_of_run.find(observable.key);
    if (values == observables_of_run.end() || !values->is_array() || values->size() != kBodyAxes.size()) continue;
    if (observable.of_box && !differ(*values)) continue;
    for (std::size_t k = 0; k < kBodyAxes.size(); ++k) {
      Headline line = headline(observable, (*values)[k]);
      line.key += fmt::format("_{}", kBodyAxes[k]);
      line.symbol += fmt::format("{}{}", line.symbol.find('_') == std::string::npos ? "_" : ",", kBodyAxes[k]);
      line.name += fmt::format(" {}", kBodyAxes[k]);
      list.push_back(std::move(line));
    }
  }
}

/// The components of the director, where there is one.
void add_director(std::vector<Headline>& list, const nlohmann::json& observables_of_run) {
  const std::optional<ed::Director> director = director_in(observables_of_run);
  const Observable* known = find_observable("director");
  if (!director || known == nullptr) return;
  for (std::size_t k = 0; k < kBodyAxes.size(); ++k) {
    Headline line = headline(*known, nullptr);
    const ed::Estimate component = component_of(*director, static_cast<int>(k));
    line.key += fmt::format("_{}", kBodyAxes[k]);
    line.symbol = fmt::format("n_{}", kBodyAxes[k]);
    line.name += fmt::format(", {}", kBodyAxes[k]);
    line.meaning = "eigenvector of the largest eigenvalue of Q, averaged over frames";
    line.value = component.value;
    line.error = component.error;
    line.missing.clear();
    list.push_back(std::move(line));
  }
}

}  // namespace

std::vector<Headline> headlines_of(const nlohmann::json& observables_of_run, bool oriented) {
  std::vector<Headline> list;
  if (!observables_of_run.is_object()) return list;
  for (const Observable* observable : observables_by(&Places::reading)) {
    if (observable->of_orientation && !oriented) continue;
    const auto estimate = observables_of_run.find(observable->key);
    if (!is_number(*observable) || estimate == observables_of_run.end() || lacks_order(*estimate)) continue;
    list.push_back(headline(*observable, *estimate));
  }
  add_axes(list, observables_of_run, oriented);
  if (oriented) add_director(list, observables_of_run);
  return list;
}

Headline headline_named(const std::string& key) {
  const Observable* known = find_observable(key);
  if (known != nullptr && is_number(*known)) return headline(*known, nullptr);
  return headline({.key = key, .symbol = key, .name = key, .unit = "1"}, nullptr);
}

std::string headline_text(const Headline& headline) {
  if (std::isfinite(headline.value)) return format_estimate({headline.value, headline.error});
  return headline.missing.empty() ? "no value" : headline.missing;
}

}  // namespace hardbody
