#pragma once

/// Time correlations, diffusion coefficients and decay times from the sums that blocks hold.

#include "observables/block_averages.h"
#include "observables/structure_results.h"

#include <optional>

namespace ed::internal {

class DirectedResults;

/// Results of the correlations of one group (kAll: of all bodies).
class CorrelationResults {
 public:
  /// Decays are fitted from the lag `fit_from` on.
  CorrelationResults(const BlockAverages& averages, const StructureResults& structure, double fit_from)
      : averages_(averages), structure_(structure), measured_(averages.measured()), fit_from_(fit_from) {}

  Correlations of_group(std::size_t group) const;

  /// Returns whether collisions change the rotation of some bodies.
  bool turned() const { return !unturned(kAll); }

 private:
  using Gap = Gaps::Gap;

  bool three_axes(std::size_t group) const;
  bool unturned(std::size_t group) const;
  bool some_unturned() const;
  double mean_rotation_axes(std::size_t group) const;

  LagRow lag_row(std::size_t lag, std::size_t group, const DirectedResults& directed) const;
  void add_lags(std::size_t group, Correlations& results) const;
  void add_diffusion(std::size_t group, Correlations& results) const;
  void add_decays(std::size_t group, Correlations& results) const;
  void add_collective_decays(std::size_t group, Correlations& results) const;
  void add_cage(std::size_t group, Correlations& results) const;
  void add_heterogeneity(std::size_t group, Correlations& results) const;
  void add_displacements(std::size_t group, Correlations& results) const;
  Estimate van_hove(std::size_t h, std::size_t bin, double volume, std::size_t group) const;
  double chi4_of(std::size_t group, const LagSums& sums) const;
  void add_axes(std::size_t group, Correlations& results) const;
  void drop_meaningless(std::size_t group, Correlations& results) const;

  template <class Value>
  Estimate decay_time_estimate(const Gap& gap, std::size_t group, const Value& value) const;
  template <class Value>
  void fit(const Gap& gap, std::size_t group, const Value& value, Estimate& tau, Estimate& beta,
           FitWindow& window) const;

  const BlockAverages& averages_;
  const StructureResults& structure_;
  const Measured& measured_;
  double fit_from_;
};

}  // namespace ed::internal
