#include "observables/structure_results.h"

#include <cmath>
#include <numbers>

namespace ed::internal {

namespace {

/// Number of blocks from which on their scatter gives an error that a peak is judged by: with fewer, the highest of
/// some thirty shells stands out by chance in more than one gas of a hundred.
constexpr std::size_t kManyBlocks = 12;

}  // namespace

StructureResults::StructureResults(const BlockAverages& averages)
    : averages_(averages), measured_(averages.measured()) {
  if (!measured_.grid.known()) return;
  wave_vectors_.emplace(wave_vectors_of(measured_.grid));
  if (measured_.blocks.empty()) return;
  sums_.resize(measured_.parts().size());
  for (std::size_t part = 0; part < sums_.size(); ++part) {
    std::vector<Sum>& sums = sums_[part];
    sums.emplace_back();
    for (const Block& block : measured_.blocks) sums.push_back({block.structure[part], block.structure_frames, {}});
    sums[0] = sums[1];
    for (std::size_t k = 2; k < sums.size(); ++k) {
      sums[0].sums.add(sums[k].sums);
      sums[0].frames += sums[k].frames;
    }
    for (Sum& sum : sums) {
      for (const double S : sum.sums.S) sum.S.push_back(S / sum.frames);
    }
  }
}

std::size_t StructureResults::part_of(std::size_t group) const {
  return group == kAll ? 0 : measured_.parts().of_group(group);
}

/// Returns the sum over one block, or (nullptr) over all.
const StructureResults::Sum& StructureResults::sum_of(std::size_t part, const Block* one) const {
  if (one == nullptr) return sums_[part][0];
  return sums_[part][static_cast<std::size_t>(one - measured_.blocks.data()) + 1];
}

/// Returns <P2> of the pairs of a bin whose bodies both have an orientation; NaN if there are none.
double StructureResults::mean_p2(std::size_t part, std::size_t bin, const Block* one) const {
  double pairs = sum_of(part, one).sums.pairs[bin];
  if (part == 0 && measured_.partly_oriented()) {
    const StructureParts parts = measured_.parts();
    if (!parts.crossed()) return kNothing;
    pairs = 0;
    for (std::size_t a = 0; a < parts.groups; ++a) {
      if (!measured_.ranges[a].oriented) continue;
      pairs += sum_of(parts.of_group(a), one).sums.pairs[bin];
      for (std::size_t b = a + 1; b < parts.groups; ++b) {
        if (measured_.ranges[b].oriented) pairs += sum_of(parts.of_pair(a, b), one).sums.pairs[bin];
      }
    }
  }
  return pairs > 0 ? sum_of(part, one).sums.p2[bin] / pairs : kNothing;
}

/// Returns g and g2 of a part with this number of pairs.
std::vector<PairRow> StructureResults::pair_rows(std::size_t part, double pairs, bool oriented) const {
  std::vector<PairRow> rows;
  const StructureGrid& grid = measured_.grid;
  const double width = grid.reach() / static_cast<double>(grid.bins());
  const double density = pairs / (grid.box * grid.box * grid.box);
  for (std::size_t k = 0; k < grid.bins(); ++k) {
    const double inner = width * static_cast<double>(k);
    const double outer = inner + width;
    const double shell = 4 * std::numbers::pi / 3 * (outer * outer * outer - inner * inner * inner);
    const Estimate g = averages_.with_block_error(0, [&](const Block* one) {
      const Sum& sum = sum_of(part, one);
      return sum.sums.pairs[k] / (sum.frames * density * shell);
    });
    Estimate g2 = averages_.with_block_error(0, [&](const Block* one) { return mean_p2(part, k, one); });
    if (!oriented) g2 = Estimate::none({MissingReason::no_orientation});
    if (const auto gap = measured_.gaps.orientations) g2 = Estimate::none({*gap});
    rows.push_back({0.5 * (inner + outer), g, g2});
  }
  return rows;
}

std::vector<WaveRow> StructureResults::wave_rows(std::size_t part) const {
  std::vector<WaveRow> rows;
  const std::vector<double>& q = wave_vectors_->wave_numbers();
  for (std::size_t k = 0; k < q.size(); ++k) {
    if (!(q[k] > 0)) continue;
    rows.push_back({q[k], averages_.with_block_error(0, [&](const Block* one) { return sum_of(part, one).S[k]; })});
  }
  return rows;
}

std::vector<CrossStructure> StructureResults::crosses() const {
  std::vector<CrossStructure> list;
  const StructureParts parts = measured_.parts();
  if (sums_.empty() || !parts.crossed()) return list;
  for (std::size_t a = 0; a < parts.groups; ++a) {
    for (std::size_t b = a + 1; b < parts.groups; ++b) {
      const BodyRange& of_a = measured_.ranges[a];
      const BodyRange& of_b = measured_.ranges[b];
      const std::size_t part = parts.of_pair(a, b);
      list.push_back({static_cast<int>(a), static_cast<int>(b),
                      pair_rows(part, of_a.size() * of_b.size(), of_a.oriented && of_b.oriented), wave_rows(part)});
    }
  }
  return list;
}

Estimate StructureResults::peak(std::size_t part, double Peak::*member) const {
  const std::vector<double>& q = wave_vectors_->wave_numbers();
  return averages_.with_block_error(
      0, [&](const Block* one) { return first_peak(q, sum_of(part, one).S, measured_.grid.length).*member; });
}

void StructureResults::add_to(Correlations& results, std::size_t group) const {
  if (sums_.empty()) return;
  const std::size_t part = part_of(group);
  const double number = group == kAll ? measured_.options.number : measured_.ranges[group].size();
  const bool oriented = group == kAll || measured_.ranges.size() == 1 || measured_.ranges[group].oriented;
  results.pairs = pair_rows(part, 0.5 * number * (number - 1), oriented);
  results.structure = wave_rows(part);
  if (has_peak(part)) {
    results.q_peak = peak(part, &Peak::q);
    results.S_peak = peak(part, &Peak::S);
  } else {
    results.q_peak = results.S_peak = Estimate::none({MissingReason::no_peak});
  }
}

std::optional<double> StructureResults::first_wave_number_of_all() const {
  return sums_.empty() ? std::nullopt : std::optional(first_wave_number());
}

/// Returns whether the first peak of a part stands out of its scatter: that of independent frames or, with enough
/// blocks, that which the blocks show.
bool StructureResults::has_peak(std::size_t part) const {
  if (clear_peak_of(part)) return true;
  if (averages_.full_blocks().size() < kManyBlocks) return false;
  const std::vector<double>& S = sum_of(part, nullptr).S;
  const std::size_t top = highest(wave_vectors_->wave_numbers(), S, measured_.grid.length);
  if (top == S.size()) return false;
  const Estimate height = averages_.with_block_error(0, [&](const Block* one) { return sum_of(part, one).S[top]; });
  return stands_out(height.value, height.error);
}

/// Returns the wave number of the first peak of a part, if it stands out of the scatter of independent frames. Frames
/// of a block hold much the same configuration and count as one.
std::optional<double> StructureResults::clear_peak_of(std::size_t part) const {
  return clear_peak(*wave_vectors_, sum_of(part, nullptr).S, static_cast<double>(measured_.blocks.size()),
                    measured_.grid.length);
}

// ---- The wave number that tells how far bodies have to move

/// Returns the wave number of the first peak of S(q) of all bodies, as a run chooses it; it tells how far bodies have
/// to move to leave their neighbours. Frames of a block hold much the same configuration and count as one.
double StructureResults::first_wave_number() const {
  const StructureGrid& grid = measured_.grid;
  const double number = measured_.options.number;
  const double packing = number * 4 * std::numbers::pi / 3 * std::pow(grid.length / grid.box, 3);
  // Mean distance of bodies, where sizes are unknown or cannot be right, because bodies would fill more than space.
  if (!measured_.length_known || packing >= 1) return 2 * std::numbers::pi * std::cbrt(number) / grid.box;
  return likely_peak(*wave_vectors_, sum_of(0, nullptr).S, static_cast<double>(measured_.blocks.size()), grid, packing);
}

double StructureResults::first_wave_number(std::size_t group) const {
  const double of_all = first_wave_number();
  if (group == kAll || measured_.ranges.size() == 1 || !measured_.length_known) return of_all;
  const auto own = clear_peak_of(group + 1);
  return own ? std::min(of_all, *own) : of_all;
}

}  // namespace ed::internal
