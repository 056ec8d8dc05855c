#pragma once

/// What is read off a time correlation: slopes and decays.

#include <ed/analysis.h>

#include <limits>
#include <optional>
#include <vector>

namespace ed::internal {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// A correlation against lag, for one block or for all.
struct Curve {
  std::vector<double> t;
  std::vector<double> y;
};

/// Diffusion is fitted from this share of the longest lag.
constexpr double kFitFrom = 0.4;
/// Decays are fitted from this many mean collision intervals: before, motion is ballistic.
constexpr double kBallisticCollisions = 5;

/// D = slope / divisor over [kFitFrom, 1] of the longest lag; NaN unless the curve is straight there.
double diffusion(const Curve& curve, double divisor);

/// Where the curve falls to 1/e; NaN if it does not.
double decay_time(const Curve& curve);

/// A fit and the lags that went into it.
struct DecayFit {
  StretchedExponential fit;
  double from;
  double to;
};

/// The stretched exponential of a correlation that starts at 1, from the lag `from` on (before, motion is ballistic),
/// the noise at the end left out. Nothing where the decay is ballistic most of the way, or `from` is not finite.
std::optional<DecayFit> fit_decay(const Curve& curve, double from);

}  // namespace ed::internal
