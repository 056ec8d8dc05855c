#include "observables/order/directed_results.h"

#include "observables/order/diffusion_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ed::internal {
namespace {

double along(const LagSums& s) {
  return s.directed.along2;
}
double across(const LagSums& s) {
  return s.msd - s.directed.along2;
}

/// Returns <r^4> over that of a Gaussian in `components` directions with the same <r^2>, less 1.
double non_gaussian(int components, double square, double fourth) {
  constexpr std::array kGaussian = {3.0, 2.0, 5.0 / 3};
  return fourth / (kGaussian[static_cast<std::size_t>(components - 1)] * square * square) - 1;
}

}  // namespace

double least_nematic_order(double number) {
  return std::max(kNematic, kAboveChance * kChance / std::sqrt(number));
}

Gaps::Gap why_no_director(const BlockAverages& averages, bool turned) {
  const Measured& measured = averages.measured();
  if (measured.gaps.orientations) return measured.gaps.orientations;
  const Estimate S = averages.frame_mean([](const Block& b) { return b.all.S; });
  if (std::isnan(S.value)) return MissingReason::not_measured;
  if (turned && S.value >= least_nematic_order(measured.options.number)) return std::nullopt;
  return MissingReason::no_director;
}

DirectedResults::DirectedResults(const BlockAverages& averages, bool turned)
    : averages_(averages),
      no_box_(averages.measured().gaps.displacements),
      no_director_(no_box_ ? no_box_ : why_no_director(averages, turned)) {}

void DirectedResults::add_to(LagRow& row, std::size_t lag, std::size_t group) const {
  const auto estimate = [&](const Gaps::Gap& gap, const auto& value) {
    if (gap) return Estimate::none({*gap});
    return averages_.with_block_error(row.lag, [&](const Block* one) {
      const LagSums sums = averages_.sums_at(lag, group, {one, nullptr});
      return sums.count > 0 ? value(sums) / sums.count : kNothing;
    });
  };
  row.msd_parallel = estimate(no_director_, along);
  row.msd_perp = estimate(no_director_, across);
  for (int edge = 0; edge < 3; ++edge) {
    row.msd_box[static_cast<std::size_t>(edge)] =
        estimate(no_box_, [edge](const LagSums& s) { return s.directed.edge2[edge]; });
  }
}

template <class Square, class Fourth>
Estimate DirectedResults::diffusion(const Gaps::Gap& gap, std::size_t group, int components, double first_wave_number,
                                    const Square& square, const Fourth& fourth) const {
  if (gap) return Estimate::none({*gap});
  const Curve squares = averages_.curve(group, {}, square);
  const std::size_t first = first_of_fit(squares);
  double deviation = 0;
  if (first < squares.y.size()) {
    deviation = non_gaussian(components, squares.y[first], averages_.curve(group, {}, fourth).y[first]);
  }
  const Reach reach = reach_of_translation(first_wave_number, deviation, components);
  return diffusion_estimate(averages_, gap, group, 2 * components, reach, square);
}

void DirectedResults::add_to(Correlations& results, std::size_t group, double first_wave_number) const {
  results.D_parallel =
      diffusion(no_director_, group, 1, first_wave_number, along, [](const LagSums& s) { return s.directed.along4; });
  results.D_perp =
      diffusion(no_director_, group, 2, first_wave_number, across, [](const LagSums& s) { return s.directed.across4; });
  for (int edge = 0; edge < 3; ++edge) {
    results.D_box[static_cast<std::size_t>(edge)] = diffusion(
        no_box_, group, 1, first_wave_number, [edge](const LagSums& s) { return s.directed.edge2[edge]; },
        [edge](const LagSums& s) { return s.directed.edge4[edge]; });
  }
}

}  // namespace ed::internal
