#pragma once

/// g(r), S(q) and its first peak from the structure that blocks hold.

#include "observables/block_averages.h"
#include "observables/structure.h"

#include <optional>
#include <vector>

namespace ed::internal {

/// Results of the static structure, of the StructureParts.
class StructureResults {
 public:
  explicit StructureResults(const BlockAverages& averages);

  /// Adds g(r), g2(r), S(q) and its peak of a part to the results.
  void add_to(Correlations& results, std::size_t group) const;

  /// Returns the structure of each two groups.
  std::vector<CrossStructure> crosses() const;

  /// Returns the first wave number of all bodies by the rule of runs; nullopt without structure.
  std::optional<double> first_wave_number_of_all() const;

  /// Returns the first wave number for a group: that of all bodies. Where its own S(q) has a clear peak at a smaller
  /// wave number, as that of large bodies that cage each other, it is that one.
  double first_wave_number(std::size_t group) const;

 private:
  /// Structure summed over frames.
  struct Sum {
    StructureSums sums;
    double frames = 0;
    std::vector<double> S;  ///< mean over frames
  };

  std::size_t part_of(std::size_t group) const;
  const Sum& sum_of(std::size_t part, const Block* one) const;
  double first_wave_number() const;
  std::optional<double> clear_peak_of(std::size_t part) const;
  bool has_peak(std::size_t part) const;
  std::vector<PairRow> pair_rows(std::size_t part, double pairs, bool oriented) const;
  std::vector<WaveRow> wave_rows(std::size_t part) const;
  double mean_p2(std::size_t part, std::size_t bin, const Block* one) const;
  Estimate peak(std::size_t part, double Peak::*member) const;

  const BlockAverages& averages_;
  const Measured& measured_;
  std::optional<WaveVectors> wave_vectors_;  ///< wave vectors of S(q), if there is a box
  std::vector<std::vector<Sum>> sums_;       ///< sums of each part: over all blocks, then of each block
};

}  // namespace ed::internal
