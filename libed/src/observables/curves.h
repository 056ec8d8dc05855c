#pragma once

/// Slopes and decays read off a time correlation, and why nothing can be read.

#include <ed/analysis.h>

#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace ed::internal {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// A correlation against lag, for one block or for all.
struct Curve {
  std::vector<double> t;
  std::vector<double> y;
};

// ---- Thresholds: where the definition of a number holds. All are dimensionless.

/// Diffusion is fitted over lags t with kFitFrom <= t / longest lag <= 1.
constexpr double kFitFrom = 0.4;
/// Diffusion: |d ln(displacement) / d ln t - 1| <= kLinearity over those lags. A curve that bends from ballistic motion
/// (slope 2) to a cage (slope 0) passes this, hence the next two.
constexpr double kLinearity = 0.2;
/// Translational diffusion: MSD q^2 / 6 >= kDisplaced at the first of those lags, q the wave number of the first peak
/// of S(q) (first_wave_number): a Gaussian F_self(q, t) is at or below 1/e there, so that bodies have left their cages.
/// Where a few bodies have moved far and the others not at all, F_self to the next order counts too:
/// exp(-x) (1 + non_gaussian x^2 / 2) <= exp(-kDisplaced), x = MSD q^2 / 6.
constexpr double kDisplaced = 1;
/// Rotational diffusion: <|Delta Phi|^2> >= kTurned c, in rad^2, at the longest lag, c the number of components.
constexpr double kTurned = 1.0 / 3;
/// Rotation that has not come to kTurned c at the first of those lags may be free still: there
/// d ln(displacement) / d ln t <= 1 + kFreeTurning is asked for, too.
constexpr double kFreeTurning = 0.1;

/// Powers of time are read off the MSD between a lag t and the first one at kSlopeSpan t or beyond. Unknown collisions:
/// decays are fitted from the first lag on where that power is at most kEndOfBallistic, halfway from ballistic motion
/// (2) to diffusion (1).
constexpr double kSlopeSpan = 1.5;
constexpr double kEndOfBallistic = 1.5;
/// Decays are fitted only if they fall to 1/e at t >= kLeastDecay times that lag.
constexpr double kLeastDecay = 3;
/// Decays are fitted while y > kNoise.
constexpr double kNoise = 0.03;
/// Fits of a correlation that starts at 1: amplitude <= kMostAmplitude, beta >= kLeastBeta, tau >= first fitted lag.
/// Others continue the decay to lags where nothing was fitted.
constexpr double kMostAmplitude = 1.3;
constexpr double kLeastBeta = 0.3;
/// A correlation that is still above kShortDecay at the longest lag has shown little but its way to 1/e, which a slower
/// decay or a plateau may follow. There the lags without the first third of them have to give the same tau, to a share
/// of kSteadyTau.
constexpr double kShortDecay = 0.25;
constexpr double kSteadyTau = 0.25;

// ---- Diffusion

/// Displacements that bodies must have reached for their motion to be diffusion.
struct Reach {
  double at_start = 0;                                       ///< least value at the first lag of the fit
  double at_end = 0;                                         ///< least value at the longest lag
  double free_below = 0;                                     ///< value at the first lag below which kFreeTurning counts
  MissingReason short_of_it = MissingReason::not_displaced;  ///< reason to give if they have not
};

/// Returns the requirements of translational diffusion in `components` directions, for the wave number of the first
/// peak of S(q) and the non-Gaussian parameter at the first lag of the fit.
Reach reach_of_translation(double first_wave_number, double non_gaussian, int components = 3);
/// Returns the requirements of rotational diffusion with this number of components.
Reach reach_of_rotation(double components);

/// Returns the index of the first lag that diffusion is fitted from; the number of lags if there are none.
std::size_t first_of_fit(const Curve& curve);

/// Returns the reason for which the mean square displacement in `curve` is not diffusion; nullopt if it is.
std::optional<Missing> why_not_diffusive(const Curve& curve, const Reach& reach);

/// Returns the slope over [kFitFrom, 1] of the last lag; NaN for fewer than two lags there.
double final_slope(const Curve& curve);

// ---- Cages

/// Cages: the MSD grows as a power of time of at most kCaged from some lag t to kSlopeSpan t.
constexpr double kCaged = 0.5;

/// Flattest part of a mean square displacement: the lag in the middle of it, and the power of time there.
struct Flattest {
  std::size_t lag = 0;
  double exponent = kNothing;  ///< NaN for too few lags
};
Flattest flattest_of(const Curve& msd);

// ---- Decays

/// Returns the lag at which the curve falls to 1/e; NaN if it does not.
double decay_time(const Curve& curve);

/// Returns the reason for which the curve does not fall to 1/e; nullopt if it does.
std::optional<Missing> why_no_decay_time(const Curve& curve);

/// Returns the lag at which a mean square displacement is ballistic no more, by kSlopeSpan; NaN if it is to the end.
double end_of_ballistic(const Curve& msd);

/// A fit and the lags that went into it.
struct DecayFit {
  StretchedExponential fit;
  double from;
  double to;
};

/// Fits a stretched exponential to a correlation that starts at 1, to lags from `from` on (before, motion is
/// ballistic), without the noise at the end. Returns nullopt where the thresholds above are not kept, or `from` is
/// infinite (no body has met another) or NaN (not known).
std::optional<DecayFit> fit_decay(const Curve& curve, double from);

/// Returns the reason for which all data have no fit: that of fit_decay, or that tau is not steady; nullopt if they
/// have one.
std::optional<Missing> why_no_fit(const Curve& curve, double from);

}  // namespace ed::internal
