#pragma once

/// Estimates as JSON. Private to the sources that write JSON: it brings the library along.

#include "io/json_values.h"
#include "run/missing.h"

#include <ed/analysis.h>
#include <ed/observables.h>

#include <nlohmann/json.hpp>

#include <cmath>

namespace hardbody {

/// {"value": ..., "error": ...}, and without a value the reason: "missing": "..."
inline nlohmann::ordered_json estimate_json(const ed::Estimate& e, const MissingWords& words) {
  nlohmann::ordered_json json = {{"value", number_json(e.value)}, {"error", number_json(e.error)}};
  if (!std::isfinite(e.value)) json["missing"] = missing_text(e.missing, words);
  return json;
}

/// Adds the decays and the first peak of S(q) under their keys in summary.json.
inline void add_decays_json(nlohmann::ordered_json& json, const ed::Correlations& c, const MissingWords& words) {
  json["tau_C2"] = estimate_json(c.tau_C2, words);
  json["beta_C2"] = estimate_json(c.beta_C2, words);
  json["t_C2_1overe"] = estimate_json(c.t_C2_1overe, words);
  json["tau_F"] = estimate_json(c.tau_F, words);
  json["beta_F"] = estimate_json(c.beta_F, words);
  json["t_F_1overe"] = estimate_json(c.t_F_1overe, words);
  json["q_peak"] = estimate_json(c.q_peak, words);
  json["S_peak"] = estimate_json(c.S_peak, words);
}

}  // namespace hardbody
