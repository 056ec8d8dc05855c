#pragma once

#include <ed/export.h>

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ed {

/// Reasons for which an Estimate has no value.
enum class MissingReason {
  not_measured,              ///< no data, or no block that is at least half complete
  no_collisions,             ///< no collisions have happened
  lags_too_short,            ///< fewer than two lags to fit, or no time origin followed up to the longest one
  ballistic,                 ///< displacements still grow faster than those of diffusion at the longest lag
  subdiffusive,              ///< displacements still grow more slowly than those of diffusion at the longest lag
  not_displaced,             ///< bodies have not moved far enough for diffusion
  not_turned,                ///< bodies have not turned far enough for rotational diffusion
  not_decayed,               ///< the correlation is still above 1/e at the longest lag
  decayed_early,             ///< the correlation is already below 1/e at the first lag
  decayed_before_diffusion,  ///< the correlation falls to 1/e before motion is diffusive
  end_of_ballistic_unknown,  ///< the lag at which ballistic motion ends is not known
  no_fit,                    ///< the best fit is not a stretched exponential: see fit_decay
  tau_unsteady,              ///< the correlation has decayed little, and tau depends on the fitted lags
  meaningless,               ///< the quantity has no meaning: nothing changes the bodies' rotation
  meaningless_in_part,       ///< the quantity of all bodies has no meaning: nothing changes the rotation of one group
  no_peak,                   ///< S(q) has no peak that stands out of its scatter
  no_cage,                   ///< the MSD has no plateau: nothing holds bodies in cages
  still_growing,             ///< the maximum is at the longest lag
  no_such_axis,              ///< bodies of revolution have no third axis
  not_told,                  ///< the stored frames do not contain the data
  not_unwrapped,             ///< positions are wrapped, or may be, and bodies move far between frames
  not_followed,              ///< frames do not identify the bodies
  no_wave_vector,            ///< the box has no wave vector of this length
  no_orientation,            ///< spheres have no orientation
  no_bragg_peak,             ///< S(q) / N of no wave vector is that of a Bragg peak
  not_asked,                 ///< the options do not ask for the quantity
  no_director,               ///< the state is isotropic, or nothing changes the bodies' rotation
};

/// Returns the enumerator's name.
ED_EXPORT const char* to_string(MissingReason reason);

/// Reason for which a value is missing, and how far motion has come.
struct Missing {
  MissingReason reason = MissingReason::not_measured;
  /// Value reached, which depends on the reason. not_displaced: root of the MSD at the first lag of the fit;
  /// not_turned: root of the rotational MSD at the longest lag, in rad; not_decayed, tau_unsteady: the correlation at
  /// the longest lag; ballistic, subdiffusive: the exponent of the power of time with which displacements grow;
  /// no_cage: the least of these exponents. NaN for other reasons.
  double reached = std::numeric_limits<double>::quiet_NaN();
  /// Lag of `reached` for not_displaced and not_turned; NaN for other reasons.
  double lag = std::numeric_limits<double>::quiet_NaN();
};

/// Describes the reason in one sentence without a full stop: "bodies have moved 0.19 l by lag 16, where the fit begins:
/// no diffusion yet". `length_unit` follows the distance.
ED_EXPORT std::string describe(const Missing& missing, std::string_view length_unit = "l");

/// Returns whether longer lags, from a longer run, may give the value.
ED_EXPORT bool longer_lags_help(MissingReason reason);

/// Measured value with its standard error. A NaN value is missing, for the reason given.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();
  Missing missing{};  ///< meaningless if there is a value

  /// Makes an estimate without a value.
  static constexpr Estimate none(Missing why) {
    Estimate e;
    e.missing = why;
    return e;
  }
};

/// Returns mean and standard error of the mean, sqrt(s^2 / n), of independent values. The error is NaN for fewer than
/// two values, both are NaN for none.
ED_EXPORT Estimate mean_of_blocks(std::span<const double> values);

/// Returns the least-squares slope of y against x; nullopt for fewer than two different x.
ED_EXPORT std::optional<double> slope(std::span<const double> x, std::span<const double> y);

/// Returns the first x at which y, falling, crosses `level`, by quadratic interpolation through the three nearest
/// points; nullopt if it does not.
ED_EXPORT std::optional<double> first_crossing(std::span<const double> x, std::span<const double> y, double level);

/// Stretched exponential A exp[-(t / tau)^beta], the paper's fit of C2.
struct StretchedExponential {
  double amplitude;  ///< dimensionless
  double tau;        ///< time constant, in the unit of t
  double beta;       ///< dimensionless; 1 for simple diffusion
};

/// Returns the least-squares fit (Levenberg-Marquardt); y may be <= 0. Returns nullopt for fewer than four points, or
/// if the fit does not converge to 0.1 < beta < 3 and tau > 0.
ED_EXPORT std::optional<StretchedExponential> fit_stretched_exponential(std::span<const double> t,
                                                                        std::span<const double> y);

}  // namespace ed
