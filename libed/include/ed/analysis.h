#pragma once

#include <ed/export.h>

#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace ed {

/// A measured value and its standard error; NaN: the run is too short for it.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();
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
