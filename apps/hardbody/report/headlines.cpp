#include "report/run.h"
#include "run/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace hardbody {
namespace {

constexpr const char* kRate = "√(kT/m)/l";
constexpr const char* kDiffusion = "l √(kT/m)";
constexpr const char* kTime = "l √(m/kT)";

/// Names of a number of summary.json.
struct Naming {
  const char* key;
  const char* symbol;
  const char* name;
  const char* unit;
  const char* meaning;
};

constexpr std::array kNamings = {
    Naming{"collision_rate", "Γ", "Collision rate", kRate, "collisions that a body takes part in, a time unit"},
    Naming{"Z", "Z", "Compressibility factor", "", "P V / (N kT)"},
    Naming{"D_trans", "D_trans", "Translational diffusion", kDiffusion, "slope of the MSD / 6"},
    Naming{"D_rot", "D_rot", "Rotational diffusion", kRate, "slope of ⟨|∫ω dt|²⟩, ω in the world frame"},
    Naming{"D_rot_body", "D_rot,body", "Rotational diffusion, body frame", kRate,
           "the same with ω along the body's axes"},
    Naming{"t_C2_1overe", "t_C2", "Orientational relaxation", kTime, "⟨P₂(u(t)·u(0))⟩ = 1/e"},
    Naming{"tau_C2", "τ_C2", "Relaxation time of C₂", kTime, "of the fit A exp[−(t/τ)^β]"},
    Naming{"beta_C2", "β_C2", "Stretching of C₂", "", "of the same fit"},
    Naming{"t_F_1overe", "t_F", "Relaxation of F_self", kTime, "F_self(q, t) = 1/e at the first peak of S(q)"},
    Naming{"tau_F", "τ_F", "Relaxation time of F_self", kTime, "of the fit A exp[−(t/τ)^β]"},
    Naming{"beta_F", "β_F", "Stretching of F_self", "", "of the same fit"},
    Naming{"S", "S", "Nematic order", "", "largest eigenvalue of Q of each frame, averaged; above 0.3 nematic"},
    Naming{"q_peak", "q_peak", "First peak of S(q)", "1/l", "its wave number"},
    Naming{"S_peak", "S(q_peak)", "Height of that peak", "", "S(q) there"},
    Naming{"kT_trans", "kT_trans", "Translational temperature", "kT",
           "on 3N − 3 degrees of freedom; exactly 1 on average"},
    Naming{"kT_rot", "kT_rot", "Rotational temperature", "kT", "the same of rotation"},
};

/// Observables of bodies without an axis of revolution: a list of three.
constexpr std::array kAxisNamings = {
    Naming{"D_rot_axes", "D", "Rotational diffusion about body", kRate, "⟨(∫ω dt)²⟩ / 2t, of that component"},
    Naming{"t_C2_1overe_axes", "t_C2", "Orientational relaxation of body", kTime, "⟨P₂(u(t)·u(0))⟩ = 1/e of that axis"},
    Naming{"kT_axes", "kT", "Rotational temperature about body", "kT", "equipartition: 1"},
};

double number_in(const nlohmann::json& estimate, const char* key) {
  const auto place = estimate.is_object() ? estimate.find(key) : estimate.end();
  if (!estimate.is_object() || place == estimate.end() || !place->is_number()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return place->get<double>();
}

std::string text_in(const nlohmann::json& estimate, const char* key) {
  const auto place = estimate.is_object() ? estimate.find(key) : estimate.end();
  if (!estimate.is_object() || place == estimate.end() || !place->is_string()) return "";
  return place->get<std::string>();
}

Headline headline(const Naming& naming, const nlohmann::json& estimate) {
  return {naming.key,
          naming.symbol,
          naming.name,
          naming.unit,
          naming.meaning,
          number_in(estimate, "value"),
          number_in(estimate, "error"),
          text_in(estimate, "missing")};
}

void add_axes(std::vector<Headline>& list, const nlohmann::json& observables) {
  constexpr std::array kAxes = {"x", "y", "z"};
  for (const Naming& naming : kAxisNamings) {
    const auto values = observables.find(naming.key);
    if (values == observables.end() || !values->is_array() || values->size() != kAxes.size()) continue;
    for (std::size_t k = 0; k < kAxes.size(); ++k) {
      Headline line = headline(naming, (*values)[k]);
      line.key += fmt::format("_{}", kAxes[k]);
      line.symbol += fmt::format("{}{}", line.symbol.find('_') == std::string::npos ? "_" : ",", kAxes[k]);
      line.name += fmt::format(" {}", kAxes[k]);
      list.push_back(std::move(line));
    }
  }
}

}  // namespace

std::vector<Headline> headlines_of(const nlohmann::json& observables) {
  std::vector<Headline> list;
  if (!observables.is_object()) return list;
  for (const Naming& naming : kNamings) {
    const auto estimate = observables.find(naming.key);
    if (estimate != observables.end()) list.push_back(headline(naming, *estimate));
  }
  add_axes(list, observables);
  return list;
}

Headline headline_named(const std::string& key) {
  const auto known = std::find_if(kNamings.begin(), kNamings.end(), [&](const Naming& n) { return key == n.key; });
  if (known != kNamings.end()) return headline(*known, nullptr);
  return headline({key.c_str(), key.c_str(), key.c_str(), "", ""}, nullptr);
}

std::string headline_text(const Headline& headline) {
  if (std::isfinite(headline.value)) return format_estimate({headline.value, headline.error});
  return headline.missing.empty() ? "no value" : headline.missing;
}

}  // namespace hardbody
