#pragma once

/// Mean square displacements and diffusion coefficients by direction.

#include "observables/block_averages.h"
#include "observables/measured.h"

#include <cstddef>
#include <optional>

namespace ed::internal {

/// A state is nematic if S, averaged over frames, is at least kNematic and kAboveChance times its mean in an isotropic
/// state: kChance / sqrt(N), the largest eigenvalue of Q of N random axes. Of 4000 states of 30 to 500 axes none has
/// more than 1.8 times that.
constexpr double kNematic = 0.3;
constexpr double kAboveChance = 4;
constexpr double kChance = 0.81;

/// Returns the least S of a nematic state of N bodies.
double least_nematic_order(double number);

/// Returns the reason for which there is no director; nullopt if there is one. `turned`: false if nothing changes the
/// bodies' rotation.
Gaps::Gap why_no_director(const BlockAverages& averages, bool turned);

/// Results by direction of the displacements that blocks hold.
class DirectedResults {
 public:
  /// `turned`: false if nothing changes the bodies' rotation; they have no director then.
  DirectedResults(const BlockAverages& averages, bool turned);

  /// Adds the displacements at a lag to its row.
  void add_to(LagRow& row, std::size_t lag, std::size_t group) const;

  /// Adds diffusion coefficients; `first_wave_number` tells how far bodies must have moved.
  void add_to(Correlations& results, std::size_t group, double first_wave_number) const;

 private:
  template <class Square, class Fourth>
  Estimate diffusion(const Gaps::Gap& gap, std::size_t group, int components, double first_wave_number,
                     const Square& square, const Fourth& fourth) const;

  const BlockAverages& averages_;
  Gaps::Gap no_box_;       ///< reason for which displacements are not known
  Gaps::Gap no_director_;  ///< reason for those along and across the director
};

}  // namespace ed::internal
