#include "curves.h"

#include <cmath>

namespace ed::internal {
namespace {

constexpr double kLinearity = 0.2;  ///< of the logarithmic slope of a displacement that counts as diffusion
constexpr double kNoise = 0.03;     ///< of a decay: what follows is left out

}  // namespace

double diffusion(const Curve& curve, double divisor) {
  if (curve.t.empty()) return kNothing;
  Curve window;
  Curve logarithms;
  for (std::size_t k = 0; k < curve.t.size(); ++k) {
    if (curve.t[k] < kFitFrom * curve.t.back() * (1 - 1e-9) || !(curve.y[k] > 0)) continue;
    window.t.push_back(curve.t[k]);
    window.y.push_back(curve.y[k]);
    logarithms.t.push_back(std::log(curve.t[k]));
    logarithms.y.push_back(std::log(curve.y[k]));
  }
  const auto exponent = slope(logarithms.t, logarithms.y);
  const auto rate = slope(window.t, window.y);
  if (!exponent || !rate || std::abs(*exponent - 1) > kLinearity) return kNothing;
  return *rate / divisor;
}

double decay_time(const Curve& curve) {
  return first_crossing(curve.t, curve.y, 1 / std::exp(1.0)).value_or(kNothing);
}

std::optional<DecayFit> fit_decay(const Curve& curve, double from) {
  // A comparison that fails if `from` is no number.
  if (!(decay_time(curve) >= 3 * from)) return std::nullopt;
  Curve window;
  for (std::size_t k = 0; k < curve.t.size() && curve.y[k] > kNoise; ++k) {
    if (curve.t[k] < from) continue;
    window.t.push_back(curve.t[k]);
    window.y.push_back(curve.y[k]);
  }
  const auto fit = fit_stretched_exponential(window.t, window.y);
  if (!fit) return std::nullopt;
  return DecayFit{*fit, window.t.front(), window.t.back()};
}

}  // namespace ed::internal
