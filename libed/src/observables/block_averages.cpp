#include "observables/block_averages.h"

namespace ed::internal {

BlockAverages::BlockAverages(const Measured& measured) : measured_(measured) {
  for (const Block& block : measured.blocks) {
    if (2 * block.origins > measured.origins_per_block && block.end.time > block.begin.time) full_.push_back(&block);
  }
}

/// Factor by which the standard error of block averages is multiplied for a correlation at `lag`: the origins of a
/// block lie in one length of time, but look ahead by the lag, so that neighbouring blocks share data.
///
/// For displacements of a Brownian particle the averages over the origins of two neighbouring blocks have the
/// correlation coefficient rho = f / (8 - 2 f), f = lag / length <= 1 (the variance is the integral of
/// (1 - s/length) (1 - s/lag)^2 over the offset s, the covariance that of s (1 - s/lag)^2), and the mean of many blocks
/// then has the variance (1 + 2 rho) times that of independent ones: at most 4/3.
double BlockAverages::shared_data_factor(double lag) const {
  const double length = measured_.origins_per_block * measured_.spacing;
  const double f = std::min(1.0, lag / length);
  return std::sqrt(1 + 2 * f / (8 - 2 * f));
}

LagSums BlockAverages::sums_at(std::size_t lag, std::size_t group, Selection selection) const {
  LagSums sums;
  double overlap2 = 0;
  const std::size_t groups = measured_.ranges.size();
  for (const Block& block : measured_.blocks) {
    if (!selection.takes(block)) continue;
    overlap2 += block.overlap2[lag];
    for (std::size_t g = 0; g < groups; ++g) {
      if (group != kAll && g != group) continue;
      if (group == kAll) {
        sums.add(block.lags[lag * groups + g], measured_.weights[g], measured_.weights_of_rotations[g]);
      } else {
        sums.add(block.lags[lag * groups + g], 1);
      }
    }
  }
  // The mean over groups holds for everything but this square.
  if (group == kAll) sums.overlap2 = overlap2;
  if (group == kAll && measured_.options.collective) add_collective(lag, selection, sums);
  return sums;
}

/// Sets F / S at one lag, times the number of origins.
void BlockAverages::add_collective(std::size_t lag, Selection selection, LagSums& sums) const {
  const std::size_t numbers = measured_.options.wave_numbers.size();
  for (std::size_t k = 0; k < numbers; ++k) {
    double later = 0;
    double at_once = 0;
    for (const Block& block : measured_.blocks) {
      if (!selection.takes(block) || block.collective.empty()) continue;
      const double* own = &block.collective[kCollectiveSums * (lag * numbers + k)];
      later += own[0];
      at_once += own[1];
    }
    sums.f_collective[k] = at_once > 0 ? sums.count * later / at_once : kNothing;
  }
}

}  // namespace ed::internal
