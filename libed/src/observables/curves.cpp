#include "observables/curves.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <span>
#include <string>

namespace ed::internal {
namespace {

const double kDecayed = std::exp(-1.0);

/// The lags that diffusion is fitted over.
Curve end_of(const Curve& curve) {
  const auto first = static_cast<std::ptrdiff_t>(first_of_fit(curve));
  return {{curve.t.begin() + first, curve.t.end()}, {curve.y.begin() + first, curve.y.end()}};
}

/// Least x >= kDisplaced beyond which exp(-x) (1 + non_gaussian x^2 / 2) stays at or below exp(-kDisplaced).
double least_displacement(double non_gaussian) {
  const auto decayed = [&](double x) {
    return std::exp(-x) * (1 + 0.5 * non_gaussian * x * x) <= std::exp(-kDisplaced);
  };
  // The function falls from x = 2 on for any non_gaussian >= 0, because x^2 exp(-x) does.
  if (!(non_gaussian > 0)) return kDisplaced;
  if (!std::isfinite(non_gaussian)) return non_gaussian;
  double low = kDisplaced;
  double high = 2;
  while (!decayed(high)) {
    low = high;
    high *= 2;
  }
  while (high - low > 1e-9 * high) {
    const double middle = 0.5 * (low + high);
    (decayed(middle) ? high : low) = middle;
  }
  return high;
}

/// Slope of ln y against ln t; NaN for fewer than two positive values.
double exponent_of(const Curve& curve) {
  Curve logarithms;
  for (std::size_t k = 0; k < curve.t.size(); ++k) {
    if (!(curve.y[k] > 0)) continue;
    logarithms.t.push_back(std::log(curve.t[k]));
    logarithms.y.push_back(std::log(curve.y[k]));
  }
  return slope(logarithms.t, logarithms.y).value_or(kNothing);
}

/// Moves `next` to the first lag at kSlopeSpan times lag k or beyond; false if there is none.
bool next_of_span(const Curve& curve, std::size_t k, std::size_t& next) {
  if (k >= curve.t.size()) return false;
  while (next < curve.t.size() && curve.t[next] < kSlopeSpan * curve.t[k]) ++next;
  return next < curve.t.size();
}

/// Slope of ln y against ln t between two lags; NaN if y is not positive.
double exponent_between(const Curve& curve, std::size_t k, std::size_t next) {
  return std::log(curve.y[next] / curve.y[k]) / std::log(curve.t[next] / curve.t[k]);
}

/// Lags that a decay is fitted to.
Curve decay_window(const Curve& curve, double from) {
  Curve window;
  for (std::size_t k = 0; k < curve.t.size() && curve.y[k] > kNoise; ++k) {
    if (curve.t[k] < from) continue;
    window.t.push_back(curve.t[k]);
    window.y.push_back(curve.y[k]);
  }
  return window;
}

/// Whether tau of a fit to `window` depends little on the lags fitted, or the correlation has come down far enough.
bool is_steady(const Curve& window, double longest_lag, double tau) {
  if (window.t.back() < longest_lag || window.y.back() <= kShortDecay) return true;
  const std::size_t first = window.t.size() / 3;
  const auto late = fit_stretched_exponential(std::span(window.t).subspan(first), std::span(window.y).subspan(first));
  return late && std::abs(late->tau - tau) <= kSteadyTau * tau;
}

}  // namespace

// ---- Diffusion

std::size_t first_of_fit(const Curve& curve) {
  const auto in_fit = [&](double t) { return t >= kFitFrom * curve.t.back() * (1 - 1e-9); };
  return static_cast<std::size_t>(std::find_if(curve.t.begin(), curve.t.end(), in_fit) - curve.t.begin());
}

Reach reach_of_translation(double first_wave_number, double non_gaussian, int components) {
  const double unit = 2 * components / (first_wave_number * first_wave_number);
  return {least_displacement(non_gaussian) * unit, 0, 0, MissingReason::not_displaced};
}

Reach reach_of_rotation(double components) {
  return {0, kTurned * components, kTurned * components, MissingReason::not_turned};
}

std::optional<Missing> why_not_diffusive(const Curve& curve, const Reach& reach) {
  if (curve.t.empty()) return Missing{};
  const Curve window = end_of(curve);
  if (window.t.size() < 2) return Missing{MissingReason::lags_too_short};
  const double exponent = exponent_of(window);
  const double steepest = window.y.front() < reach.free_below ? kFreeTurning : kLinearity;
  if (exponent > 1 + steepest) return Missing{MissingReason::ballistic, exponent};
  // Comparisons that fail if a number is none.
  if (!(window.y.front() >= reach.at_start && window.y.back() >= reach.at_end)) {
    // Place where too little is reached: the beginning of the fit, or its end.
    const bool early = !(window.y.front() >= reach.at_start);
    return Missing{reach.short_of_it, std::sqrt(std::abs(early ? window.y.front() : window.y.back())),
                   early ? window.t.front() : window.t.back()};
  }
  if (!(exponent >= 1 - kLinearity)) return Missing{MissingReason::subdiffusive, exponent};
  return std::nullopt;
}

double final_slope(const Curve& curve) {
  const Curve window = end_of(curve);
  return slope(window.t, window.y).value_or(kNothing);
}

// ---- Decays

double end_of_ballistic(const Curve& msd) {
  for (std::size_t k = 0, next = 0; next_of_span(msd, k, next); ++k) {
    if (exponent_between(msd, k, next) <= kEndOfBallistic) return msd.t[k];
  }
  return kNothing;
}

Flattest flattest_of(const Curve& msd) {
  Flattest flattest;
  for (std::size_t k = 0, next = 0; next_of_span(msd, k, next); ++k) {
    const double exponent = exponent_between(msd, k, next);
    if (std::isnan(flattest.exponent) || exponent < flattest.exponent) flattest = {(k + next) / 2, exponent};
  }
  return flattest;
}

double decay_time(const Curve& curve) {
  return first_crossing(curve.t, curve.y, kDecayed).value_or(kNothing);
}

std::optional<Missing> why_no_decay_time(const Curve& curve) {
  if (curve.t.empty()) return Missing{};
  if (std::isfinite(decay_time(curve))) return std::nullopt;
  if (curve.y.front() <= kDecayed) return Missing{MissingReason::decayed_early};
  return Missing{MissingReason::not_decayed, curve.y.back()};
}

std::optional<DecayFit> fit_decay(const Curve& curve, double from) {
  // A comparison that fails if `from` is no number.
  if (!(decay_time(curve) >= kLeastDecay * from)) return std::nullopt;
  const Curve window = decay_window(curve, from);
  const auto fit = fit_stretched_exponential(window.t, window.y);
  if (!fit || fit->amplitude > kMostAmplitude || fit->beta < kLeastBeta || fit->tau < window.t.front()) {
    return std::nullopt;
  }
  return DecayFit{*fit, window.t.front(), window.t.back()};
}

std::optional<Missing> why_no_fit(const Curve& curve, double from) {
  if (curve.t.empty()) return Missing{};
  if (std::isinf(from)) return Missing{MissingReason::no_collisions};
  if (std::isnan(from)) return Missing{MissingReason::end_of_ballistic_unknown};
  if (const auto missing = why_no_decay_time(curve)) return missing;
  if (decay_time(curve) < kLeastDecay * from) return Missing{MissingReason::decayed_before_diffusion};
  const auto found = fit_decay(curve, from);
  if (!found) return Missing{MissingReason::no_fit};
  if (!is_steady(decay_window(curve, from), curve.t.back(), found->fit.tau)) {
    return Missing{MissingReason::tau_unsteady, curve.y.back()};
  }
  return std::nullopt;
}

}  // namespace ed::internal

namespace ed {

std::string describe(const Missing& missing, std::string_view length_unit) {
  const auto text_of = [](double value) {
    char number[32];
    std::snprintf(number, sizeof number, "%.2g", value);
    return std::string(number);
  };
  const auto reached = [&](const char* before, std::string_view unit, const std::string& after) {
    return before + text_of(missing.reached) + (unit.empty() ? "" : " ") + std::string(unit) + after;
  };
  switch (missing.reason) {
    case MissingReason::not_measured:
      return "too little has been measured";
    case MissingReason::no_collisions:
      return "no body has met another";
    case MissingReason::lags_too_short:
      return "too few lags, up to the longest one, have been followed";
    case MissingReason::ballistic:
      return reached("displacements grow as t^", "", " up to the longest lag: still in part ballistic");
    case MissingReason::subdiffusive:
      return reached("displacements grow as t^", "", " up to the longest lag: not yet diffusive");
    case MissingReason::not_displaced:
      return reached("bodies have moved ", length_unit,
                     " by lag " + text_of(missing.lag) + ", where the fit begins: no diffusion yet");
    case MissingReason::not_turned:
      return reached("bodies have turned ", "rad", " within the longest lag: no diffusion yet");
    case MissingReason::not_decayed:
      return reached("still ", "", " at the longest lag: not down to 1/e");
    case MissingReason::decayed_early:
      return "below 1/e at the first lag already";
    case MissingReason::decayed_before_diffusion:
      return "decayed before motion is diffusive: no longer run helps";
    case MissingReason::end_of_ballistic_unknown:
      return "it is not known from which lag on motion is diffusive";
    case MissingReason::no_fit:
      return "no stretched exponential fits: amplitude, tau or beta is out of range";
    case MissingReason::tau_unsteady:
      return reached("still ", "", " at the longest lag: tau depends on the lags that are fitted");
    case MissingReason::meaningless:
      return "meaningless: nothing turns these bodies";
    case MissingReason::meaningless_in_part:
      return "meaningless for all bodies: nothing turns those of one species";
    case MissingReason::no_peak:
      return "S(q) has no peak that stands out of its scatter";
    case MissingReason::no_cage:
      return reached("displacements grow as t^", "", " and faster at all lags: no cage holds bodies");
    case MissingReason::still_growing:
      return "largest at the longest lag: the maximum may be beyond";
    case MissingReason::no_such_axis:
      return "bodies of revolution have no such axis";
    case MissingReason::not_told:
      return "the file does not tell";
    case MissingReason::not_unwrapped:
      return "positions are wrapped, or may be, and bodies move far between frames";
    case MissingReason::not_followed:
      return "the file does not tell which body is which from frame to frame";
    case MissingReason::no_wave_vector:
      return "the box has no wave vector of this length: a larger system has";
    case MissingReason::no_orientation:
      return "spheres have no orientation";
    case MissingReason::no_bragg_peak:
      return "no wave vector scatters enough: there is no Bragg peak";
    case MissingReason::not_asked:
      return "not asked for";
    case MissingReason::no_director:
      return "there is no director: S is not clearly above that of an isotropic state";
  }
  return "";
}

const char* to_string(MissingReason reason) {
  switch (reason) {
    case MissingReason::not_measured:
      return "not_measured";
    case MissingReason::no_collisions:
      return "no_collisions";
    case MissingReason::lags_too_short:
      return "lags_too_short";
    case MissingReason::ballistic:
      return "ballistic";
    case MissingReason::subdiffusive:
      return "subdiffusive";
    case MissingReason::not_displaced:
      return "not_displaced";
    case MissingReason::not_turned:
      return "not_turned";
    case MissingReason::not_decayed:
      return "not_decayed";
    case MissingReason::decayed_early:
      return "decayed_early";
    case MissingReason::decayed_before_diffusion:
      return "decayed_before_diffusion";
    case MissingReason::end_of_ballistic_unknown:
      return "end_of_ballistic_unknown";
    case MissingReason::no_fit:
      return "no_fit";
    case MissingReason::tau_unsteady:
      return "tau_unsteady";
    case MissingReason::meaningless:
      return "meaningless";
    case MissingReason::meaningless_in_part:
      return "meaningless_in_part";
    case MissingReason::no_peak:
      return "no_peak";
    case MissingReason::no_cage:
      return "no_cage";
    case MissingReason::still_growing:
      return "still_growing";
    case MissingReason::no_such_axis:
      return "no_such_axis";
    case MissingReason::not_told:
      return "not_told";
    case MissingReason::not_unwrapped:
      return "not_unwrapped";
    case MissingReason::not_followed:
      return "not_followed";
    case MissingReason::no_wave_vector:
      return "no_wave_vector";
    case MissingReason::no_orientation:
      return "no_orientation";
    case MissingReason::no_director:
      return "no_director";
    case MissingReason::no_bragg_peak:
      return "no_bragg_peak";
    case MissingReason::not_asked:
      return "not_asked";
  }
  return "unknown";
}

bool longer_lags_help(MissingReason reason) {
  switch (reason) {
    case MissingReason::still_growing:
    case MissingReason::lags_too_short:
    case MissingReason::ballistic:
    case MissingReason::subdiffusive:
    case MissingReason::not_displaced:
    case MissingReason::not_turned:
    case MissingReason::not_decayed:
    case MissingReason::tau_unsteady:
      return true;
    default:
      return false;
  }
}

}  // namespace ed
