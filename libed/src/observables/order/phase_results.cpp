#include "observables/order/phase_results.h"

#include "observables/order/bragg.h"
#include "observables/order/phase_sums.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ed::internal {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr std::size_t kMostRows = 32;

/// Mean over the frames whose structure was measured.
template <class Value>
Estimate structure_mean(const BlockAverages& averages, const Value& value) {
  return averages.with_block_error(0, [&](const Block* one) {
    double sum = 0;
    double frames = 0;
    for (const Block& block : averages.measured().blocks) {
      if (one != nullptr && &block != one) continue;
      if (!(block.structure_frames > 0)) continue;
      sum += value(block);
      frames += block.structure_frames;
    }
    return frames > 0 ? sum / frames : kNothing;
  });
}

/// Root of an intensity, with its error.
Estimate root_of(const Estimate& intensity) {
  const double root = std::sqrt(intensity.value);
  return {root, root > 0 ? intensity.error / (2 * root) : kNothing};
}

/// The modulus of the density wave of the strongest peak that `takes` takes, by the cosine of its angle to the
/// director.
template <class Takes>
Estimate strongest_wave(const Results& results, double least, const Takes& takes) {
  for (const BraggRow& row : results.bragg) {
    if (!takes(std::cos(row.angle))) continue;
    if (!(row.intensity.value >= least)) break;
    return root_of(row.intensity);
  }
  return Estimate::none({MissingReason::no_bragg_peak});
}

void add_peaks(const BlockAverages& averages, Results& results) {
  const Measured& measured = averages.measured();
  const double unit = 2 * std::numbers::pi / measured.grid.box;
  for (std::size_t k = 0; k < measured.followed.size(); ++k) {
    const Vector3i& n = measured.followed[k];
    const Vector3d q = unit * n.cast<double>();
    BraggRow row{n, q.norm(), structure_mean(averages, [k](const Block& b) { return b.phase.intensities[k]; }),
                 kNothing};
    if (results.director.exists) {
      row.angle = std::acos(std::min(1.0, std::abs(q.normalized().dot(results.director.axis))));
    }
    results.bragg.push_back(row);
  }
  std::stable_sort(results.bragg.begin(), results.bragg.end(),
                   [](const BraggRow& a, const BraggRow& b) { return a.intensity.value > b.intensity.value; });
}

void add_hexatic(const BlockAverages& averages, Results& results) {
  const Measured& measured = averages.measured();
  const auto estimate = [&](double HexaticOrder::*member) {
    if (!measured.options.bonds.hexatic) return Estimate::none({MissingReason::not_asked});
    if (!results.director.exists || !measured.any_oriented()) return Estimate::none({MissingReason::no_director});
    if (!(measured.axial_length > 0)) return Estimate::none({MissingReason::not_told});
    return structure_mean(averages, [member](const Block& b) { return b.phase.hexatic.*member; });
  };
  results.psi6 = estimate(&HexaticOrder::coherent);
  results.psi6_local = estimate(&HexaticOrder::local);
}

}  // namespace

void add_phase(const BlockAverages& averages, Results& results) {
  const Measured& measured = averages.measured();
  const auto estimate = [&](double PhaseSums::*member) {
    if (!measured.options.bonds.steinhardt) return Estimate::none({MissingReason::not_asked});
    return structure_mean(averages, [member](const Block& b) { return b.phase.*member; });
  };
  results.q4 = estimate(&PhaseSums::q4);
  results.q6 = estimate(&PhaseSums::q6);
  add_hexatic(averages, results);
  add_peaks(averages, results);
  const double least = least_bragg_peak(measured.options.number);
  results.bragg_peak = results.smectic_order = results.columnar_order = Estimate::none({MissingReason::no_bragg_peak});
  if (results.bragg.empty()) return;
  if (results.bragg[0].intensity.value >= least) results.bragg_peak = results.bragg[0].intensity;
  if (!results.director.exists) {
    results.smectic_order = results.columnar_order = Estimate::none({MissingReason::no_director});
  } else {
    results.smectic_order = strongest_wave(results, least, [](double cosine) { return cosine >= kCosineAlong; });
    results.columnar_order = strongest_wave(results, least, [](double cosine) { return cosine <= kCosineAcross; });
  }
  if (results.bragg.size() > kMostRows) results.bragg.resize(kMostRows);
}

void add_cubatic(const BlockAverages& averages, std::size_t part, bool three_axes, GroupResults& results) {
  const Measured& measured = averages.measured();
  results.cubatic_order = Estimate::none({MissingReason::no_such_axis});
  if (!three_axes) return;
  if (measured.gaps.orientations) {
    results.cubatic_order = Estimate::none({*measured.gaps.orientations});
    return;
  }
  results.cubatic_order = structure_mean(averages, [part](const Block& b) { return b.phase.cubatic[part]; });
}

}  // namespace ed::internal
