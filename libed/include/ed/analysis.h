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
  not_measured,              ///< nothing has been measured, or not even one block of it
  no_collisions,             ///< no body has met another
  lags_too_short,            ///< fewer than two lags to fit, or no time origin followed up to the longest one
  ballistic,                 ///< displacements still grow faster than those of diffusion at the longest lag
  subdiffusive,              ///< displacements still grow more slowly than those of diffusion at the longest lag
  not_displaced,             ///< bodies have not moved far enough for diffusion
  not_turned,                ///< bodies have not turned far enough for rotational diffusion
  not_decayed,               ///< the correlation is still above 1/e at the longest lag
  decayed_early,             ///< the correlation is below 1/e at the first lag
  decayed_before_diffusion,  ///< the correlation falls to 1/e before motion is diffusive
  end_of_ballistic_unknown,  ///< nobody knows from which lag on motion is diffusive
  no_fit,                    ///< the stretched exponential that fits best is none: see fit_decay
  tau_unsteady,              ///< the correlation has come down little, and tau depends on the lags that are fitted
  meaningless,               ///< the quantity has no meaning: nothing turns the bodies
  no_such_axis,              ///< bodies of revolution have no third axis
  not_told,                  ///< the file does not tell
  not_unwrapped,             ///< positions are wrapped, or may be, and bodies move far between frames
  not_followed,              ///< frames do not say which body is which
};

/// The enumerator's name.
ED_EXPORT const char* to_string(MissingReason reason);

/// Reason for which a value is missing, and how far motion has come.
struct Missing {
  MissingReason reason = MissingReason::not_measured;
  /// not_displaced: root of the MSD at the first lag of the fit; not_turned: the same of the rotation at the longest
  /// lag, in rad; not_decayed, tau_unsteady: the correlation there; ballistic, subdiffusive: the power of time that
  /// displacements grow with. NaN for other reasons.
  double reached = std::numeric_limits<double>::quiet_NaN();
  /// not_displaced, not_turned: the lag of `reached`. NaN for other reasons.
  double lag = std::numeric_limits<double>::quiet_NaN();
};

/// Describes the reason in one sentence without a full stop: "bodies have moved 0.19 l by lag 16, where the fit begins:
/// no diffusion yet". `length_unit` follows the distance.
ED_EXPORT std::string describe(const Missing& missing, std::string_view length_unit = "l");

/// Whether longer lags, of a longer run, may give the value.
ED_EXPORT bool longer_lags_help(MissingReason reason);

/// A measured value and its standard error. A NaN value is missing, for the reason given.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();
  Missing missing{};  ///< without meaning where there is a value

  /// Makes an estimate without a value.
  static constexpr Estimate none(Missing why) {
    Estimate e;
    e.missing = why;
    return e;
  }
};

/// Mean and standard error of the mean, sqrt(s^2 / n), of independent values; error NaN for fewer than two, both NaN
/// for none.
ED_EXPORT Estimate mean_of_blocks(std::span<const double> values);

/// Least-squares slope of y against x; nothing for fewer than two different x.
ED_EXPORT std::optional<double> slope(std::span<const double> x, std::span<const double> y);

/// The first x at which y, falling, crosses `level`: quadratic interpolation through the three nearest points; nothing
/// if it does not.
ED_EXPORT std::optional<double> first_crossing(std::span<const double> x, std::span<const double> y, double level);

/// A exp[-(t / tau)^beta], the paper's fit of C2.
struct StretchedExponential {
  double amplitude;  ///< dimensionless
  double tau;        ///< in the unit of t
  double beta;       ///< dimensionless; 1 for simple diffusion
};

/// Least-squares fit (Levenberg-Marquardt); y > 0 is not needed. Nothing for fewer than four points, or if the fit does
/// not converge to 0.1 < beta < 3 and tau > 0.
ED_EXPORT std::optional<StretchedExponential> fit_stretched_exponential(std::span<const double> t,
                                                                        std::span<const double> y);

}  // namespace ed
