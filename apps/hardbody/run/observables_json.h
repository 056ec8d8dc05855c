#pragma once

/// Observables as JSON. Private to the sources that write JSON: it brings the library along.

#include "registry/observables.h"
#include "run/missing.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <optional>

namespace hardbody {

/// Source of observables: a run, or stored frames, which tell some of them only.
enum class Source { run, frames };

/// Returns the observables of a part under their keys, in the order of summary.json; Source::frames: only those that
/// stored frames tell. A number is {"value": ..., "error": ...}; without a value it has the reason, "missing": "...".
nlohmann::ordered_json observables_json(const Part& part, const MissingWords& words, Source source);

/// Returns whether an observable, as written by observables_json, is left out of tables: the state has no order of that
/// kind.
template <class Json>
bool lacks_order(const Json& estimate) {
  if (!estimate.is_object()) return false;
  const auto missing = estimate.find("missing");
  if (missing == estimate.end()) return false;
  return *missing == ed::describe({ed::MissingReason::no_director}) ||
         *missing == ed::describe({ed::MissingReason::no_bragg_peak});
}

/// Returns the director that observables_json has written; nullopt if the state has none.
template <class Json>
std::optional<ed::Director> director_in(const Json& observables) {
  const auto director = observables.find("director");
  const auto along = observables.find("D_parallel");
  if (director == observables.end() || along == observables.end() || lacks_order(*along)) return std::nullopt;
  const auto value = director->find("value");
  const auto error = director->find("error");
  if (value == director->end() || !value->is_array() || value->size() != 3 || error == director->end()) {
    return std::nullopt;
  }
  ed::Director found;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(*value)[k].is_number()) return std::nullopt;
    found.axis[static_cast<Eigen::Index>(k)] = (*value)[k].template get<double>();
  }
  if (error->is_number()) found.error = error->template get<double>();
  return found;
}

}  // namespace hardbody
