#pragma once

/// Values from all blocks of a run, with standard errors from the scatter of the blocks.

#include "observables/curves.h"
#include "observables/measured.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace ed::internal {

/// Blocks that a value is computed from: all of them, only one, or all but one.
struct Selection {
  const Block* only = nullptr;
  const Block* without = nullptr;

  bool takes(const Block& block) const { return (only == nullptr || &block == only) && &block != without; }
};

/// Averages over blocks.
class BlockAverages {
 public:
  explicit BlockAverages(const Measured& measured);

  const Measured& measured() const { return measured_; }
  double longest_lag() const { return measured_.lags.back(); }
  /// Blocks that errors are computed from: those that are complete, or at least half so.
  const std::vector<const Block*>& full_blocks() const { return full_; }

  /// Returns the sums over the bodies of a group (kAll: of all) at one lag, in the blocks of a selection.
  LagSums sums_at(std::size_t lag, std::size_t group, Selection selection = {}) const;

  /// Returns the mean over the origins of a selection, against lag.
  template <class Value>
  Curve curve(std::size_t group, Selection selection, const Value& value) const {
    Curve result;
    for (std::size_t k = 0; k < measured_.lags.size(); ++k) {
      const LagSums sums = sums_at(k, group, selection);
      if (!(sums.count > 0)) continue;
      result.t.push_back(measured_.lags[k]);
      result.y.push_back(value(sums) / sums.count);
    }
    return result;
  }

  /// Returns the value from all data, of(nullptr), with the standard error of the values from each block, for a
  /// quantity that depends on correlations up to `lag`.
  template <class Of>
  Estimate with_block_error(double lag, const Of& of) const {
    Estimate all{of(nullptr), kNothing};
    if (!std::isfinite(all.value)) return {};
    std::vector<double> values;
    for (const Block* block : full_) {
      const double value = of(block);
      if (std::isfinite(value)) values.push_back(value);
    }
    all.error = shared_data_factor(lag) * mean_of_blocks(values).error;
    return all;
  }

  /// Returns the value from all data with its standard error, for a quantity that a single block may be too short for:
  /// where some block has none, the error is that of the jackknife, of which no block is left out.
  template <class Of>
  Estimate with_error_of_all_blocks(double lag, const Of& of) const {
    const auto lacking = [&](const Block* block) { return !std::isfinite(of(Selection{block, nullptr})); };
    if (std::none_of(full_.begin(), full_.end(), lacking)) {
      return with_block_error(lag, [&](const Block* block) { return of(Selection{block, nullptr}); });
    }
    return with_jackknife_error(lag, of);
  }

  /// Returns the value from all data with the standard error of the jackknife, for a quantity that is no mean over
  /// data, of which a single block gives another value.
  template <class Of>
  Estimate with_jackknife_error(double lag, const Of& of) const {
    Estimate all{of(Selection{}), kNothing};
    if (!std::isfinite(all.value)) return {};
    if (full_.size() < 2) return all;
    std::vector<double> values;
    for (const Block* block : full_) values.push_back(of(Selection{nullptr, block}));
    // sqrt((n - 1) / n sum of squares), against sqrt(1 / (n (n - 1)) sum of squares); NaN if a value is.
    all.error = shared_data_factor(lag) * (static_cast<double>(values.size()) - 1) * mean_of_blocks(values).error;
    return all;
  }

  /// Returns the mean of one number of a frame over all frames, with the error of the means of blocks.
  template <class Value>
  Estimate frame_mean(const Value& value) const {
    std::vector<double> means;
    for (const Block* block : full_) means.push_back(value(*block) / block->frames);
    Estimate result = mean_of_blocks(means);
    if (means.empty()) return result;
    double sum = 0;
    double frames = 0;
    for (const Block& block : measured_.blocks) {
      sum += value(block);
      frames += block.frames;
    }
    result.value = sum / frames;
    return result;
  }

 private:
  double shared_data_factor(double lag) const;
  void add_collective(std::size_t lag, Selection selection, LagSums& sums) const;

  const Measured& measured_;
  std::vector<const Block*> full_;
};

}  // namespace ed::internal
