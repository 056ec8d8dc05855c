#pragma once

#include <ed/export.h>
#include <ed/system.h>

#include <cstdint>
#include <vector>

namespace ed {

/// How the sizes of the bodies of a polydisperse species are distributed.
enum class SizeDistribution {
  uniform,    ///< between 1 - sqrt(3) width and 1 + sqrt(3) width
  gaussian,   ///< cut off kSizeCutoff standard deviations from its centre
  lognormal,  ///< the logarithm is Gaussian, cut off in the same way
};

/// The enumerator's name.
ED_EXPORT const char* to_string(SizeDistribution distribution);

/// Where a Gaussian (of the size, or of its logarithm) is cut off, in its standard deviations before the cut. Nobody's
/// results should hang on one body in a thousand that is ten times as large as the others, or that has no size left.
inline constexpr double kSizeCutoff = 3;

/// The largest width of a distribution: 0.5, 0.3 and 0.5. The smallest sizes are then 0.13, 0.09 and 0.21 of the mean.
ED_EXPORT double widest(SizeDistribution distribution);

/// Sizes relative to the nominal one, drawn independently: mean 1 and standard deviation `width`, both exactly those of
/// the distribution after it was cut off (the sizes drawn scatter about them, as any sample). The same seed gives the
/// same sizes, and the first of a larger number. Throws std::invalid_argument unless 0 < width <= widest and number >=
/// 0.
ED_EXPORT std::vector<double> draw_sizes(SizeDistribution distribution, double width, int number, std::uint64_t seed);

/// The same body `factor` times as large, of the same density: mass times factor^3, moments of inertia times factor^5.
/// Throws std::invalid_argument for a CustomShape, which cannot be scaled, and unless factor is positive and finite.
ED_EXPORT Species scaled(const Species& species, double factor);

}  // namespace ed
