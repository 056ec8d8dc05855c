#pragma once

/// Pooling of runs that differ in their seed alone.

#include <ed/analysis.h>
#include <ed/export.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace ed {

/// Seeds of replicas are below this, so that every program reads them exactly.
inline constexpr std::int64_t kReplicaSeedEnd = std::int64_t{1} << 53;

/// Returns the seed of a replica: `seed` itself for replica 0, otherwise
/// mix(mix(seed) + replica * 0x9e3779b97f4a7c15) / 2^11 with SplitMix64's finaliser `mix`, all modulo 2^64.
ED_EXPORT std::int64_t replica_seed(std::int64_t seed, int replica);

/// Number of blocks that the errors of a run are assumed to come from, at least: production / longest lag.
inline constexpr int kBlocksOfRun = 16;

/// Replicas disagree if a chi-square as large has a smaller probability.
inline constexpr double kDisagreement = 1e-3;
/// The others agree if a chi-square as large has at least this probability.
inline constexpr double kAgreement = 1e-2;

/// Replica without which all others agree.
struct Outlier {
  std::size_t replica;
  double errors;  ///< distance from the mean of the others, in standard errors of the difference
};

/// Mean of replicas. All errors are standard errors of this mean.
struct Pooled {
  std::size_t number = 0;  ///< replicas
  Estimate mean;           ///< error: the larger of `within` and student_factor() times `between`
  /// Error by the errors of the runs, sqrt(sum w^2 s^2), w the weights with sum 1. NaN if a run has none.
  double within = std::numeric_limits<double>::quiet_NaN();
  /// Error by the scatter of the runs, sqrt(sum w (x - mean)^2 / (number - 1)). NaN for a single run.
  double between = std::numeric_limits<double>::quiet_NaN();
  int degrees_of_freedom = 0;  ///< number - 1, those of the chi-square
  /// Chi-square of the agreement, (number - 1) between^2 / within^2. NaN unless both errors are known and positive.
  double chi_square = std::numeric_limits<double>::quiet_NaN();
  /// Probability of a chi-square at least as large for replicas that agree and whose errors come from kBlocksOfRun
  /// blocks each: that of Fisher's F. NaN without a chi-square.
  double probability = std::numeric_limits<double>::quiet_NaN();
  std::optional<Outlier> outlier;  ///< only if probability < kDisagreement, of three replicas or more
};

/// Pools the results of independent runs. `weights`, positive, are proportional to the inverse variances: lengths of
/// the productions; empty for equal ones. The errors of the runs are no weights: they are known too badly, and
/// correlated with the values. Throws std::invalid_argument for values that are not finite, and for weights that are
/// not positive or of another number.
ED_EXPORT Pooled pool(std::span<const Estimate> replicas, std::span<const double> weights = {});

/// Returns the factor by which the scatter of number >= 2 values is multiplied, so that mean +- error contains the true
/// mean with the probability 68.27 % of one standard deviation: the quantile of Student's t; 1.84 for 2, 1.08 for 8.
/// Throws std::invalid_argument for fewer.
ED_EXPORT double student_factor(std::size_t number);

/// Returns the probability that a variable of Fisher's F distribution exceeds x >= 0.
ED_EXPORT double fisher_tail(double x, double degrees_of_numerator, double degrees_of_denominator);

}  // namespace ed
