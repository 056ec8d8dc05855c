#pragma once

#include <ed/export.h>
#include <ed/system.h>

#include <cstdint>
#include <vector>

namespace ed {

/// Distribution of the sizes of the bodies of a polydisperse species.
enum class SizeDistribution {
  uniform,    ///< uniform between 1 - sqrt(3) width and 1 + sqrt(3) width
  gaussian,   ///< Gaussian, cut off kSizeCutoff standard deviations from its centre
  lognormal,  ///< Gaussian distribution of the logarithm, cut off in the same way
};

/// Returns the enumerator's name.
ED_EXPORT const char* to_string(SizeDistribution distribution);

/// Cut-off of a Gaussian (of the size, or of its logarithm), in its standard deviations before the cut. It avoids
/// results that depend on one body in a thousand that is ten times as large as the others, or has almost no size.
inline constexpr double kSizeCutoff = 3;

/// Returns the largest width of a distribution: 0.5, 0.3 and 0.5. The smallest sizes are then 0.13, 0.09 and 0.21 of
/// the mean.
ED_EXPORT double widest(SizeDistribution distribution);

/// Draws sizes relative to the nominal one, independently. Mean 1 and standard deviation `width` are exactly those of
/// the distribution after it was cut off (the sizes drawn scatter about them, as any sample). The same seed gives the
/// same sizes, and also the first ones of a larger number. Throws std::invalid_argument unless 0 < width <= widest and
/// number >= 0.
ED_EXPORT std::vector<double> draw_sizes(SizeDistribution distribution, double width, int number, std::uint64_t seed);

/// Returns a species `factor` times as large, of the same density: mass times factor^3, moments of inertia times
/// factor^5. Throws std::invalid_argument for a CustomShape, which cannot be scaled, and unless factor is positive and
/// finite.
ED_EXPORT Species scaled(const Species& species, double factor);

}  // namespace ed
