#pragma once

/// Numbers as the program writes them in JSON. Private to the sources that write JSON: it brings the library along.

#include "run/missing.h"

#include <ed/analysis.h>
#include <ed/observables.h>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <cmath>

namespace hardbody {

/// JSON knows no NaN: null stands for a number that is not finite.
inline nlohmann::ordered_json number_json(double x) {
  return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(nullptr);
}

inline nlohmann::ordered_json list_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

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
