#include "observables/correlation_results.h"

#include "observables/order/diffusion_estimate.h"
#include "observables/order/directed_results.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ed::internal {
namespace {

/// Blocks whose C2 at the longest lag differ by no more are of bodies that nothing turns: rounding leaves 1e-15 to
/// 1e-12, one body in a million that a collision has turned 1e-7.
constexpr double kUnturned = 1e-11;

double alpha2(const LagSums& s) {
  return 3 * s.r4 * s.count / (5 * s.msd * s.msd) - 1;
}

}  // namespace

// ---- Estimates

template <class Value>
Estimate CorrelationResults::decay_time_estimate(const Gap& gap, std::size_t group, const Value& value) const {
  if (gap) return Estimate::none({*gap});
  if (const auto missing = why_no_decay_time(averages_.curve(group, {}, value))) return Estimate::none(*missing);
  return averages_.with_error_of_all_blocks(
      averages_.longest_lag(), [&](Selection part) { return decay_time(averages_.curve(group, part, value)); });
}

/// Sets tau, beta and the window of a stretched exponential.
template <class Value>
void CorrelationResults::fit(const Gap& gap, std::size_t group, const Value& value, Estimate& tau, Estimate& beta,
                             FitWindow& window) const {
  const Curve all = gap ? Curve{} : averages_.curve(group, {}, value);
  if (const auto missing = gap ? Missing{*gap} : why_no_fit(all, fit_from_)) {
    tau = beta = Estimate::none(*missing);
    return;
  }
  const auto estimate = [&](double StretchedExponential::*member) {
    return averages_.with_error_of_all_blocks(averages_.longest_lag(), [&](Selection part) {
      const auto found = fit_decay(averages_.curve(group, part, value), fit_from_);
      return found ? found->fit.*member : kNothing;
    });
  };
  tau = estimate(&StretchedExponential::tau);
  beta = estimate(&StretchedExponential::beta);
  if (const auto found = fit_decay(all, fit_from_)) window = {found->from, found->to};
}

// ---- Bodies

bool CorrelationResults::three_axes(std::size_t group) const {
  const std::vector<BodyRange>& ranges = measured_.ranges;
  return group == kAll ? ranges.size() == 1 && ranges[0].three_axes : ranges[group].three_axes;
}

double CorrelationResults::mean_rotation_axes(std::size_t group) const {
  const std::vector<BodyGroup>& groups = measured_.options.groups;
  if (group != kAll) return groups[group].rotation_axes;
  double mean = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) mean += measured_.weights_of_rotations[g] * groups[g].rotation_axes;
  return mean;
}

/// True if nothing turns the bodies, as with spheres, and in a gas in which nothing has met: all blocks then hold one
/// and the same motion, and their scatter, which is rounding, is no error. Rounding grows with time: of spheres it need
/// not be asked.
bool CorrelationResults::unturned(std::size_t group) const {
  if (group == kAll ? !measured_.any_oriented() : !measured_.ranges[group].oriented) return true;
  std::vector<double> c2;
  for (const Block* block : averages_.full_blocks()) {
    const Curve all = averages_.curve(group, {block, nullptr}, [](const LagSums& s) { return s.c2; });
    if (!all.t.empty() && all.t.back() == averages_.longest_lag()) c2.push_back(all.y.back());
  }
  if (c2.size() < 2) return false;
  const auto [least, most] = std::minmax_element(c2.begin(), c2.end());
  return *most - *least < kUnturned;
}

bool CorrelationResults::some_unturned() const {
  for (std::size_t g = 0; g < measured_.ranges.size(); ++g) {
    if (measured_.weights_of_rotations[g] > 0 && unturned(g)) return true;
  }
  return false;
}

/// Removes rotational diffusion and its fits where nothing turns the bodies, since they mean nothing then.
/// Correlations, and the lag at which C2 is 1/e, are right, but no error of them is known. Where that holds for one
/// group, it holds for the means over all bodies: the mean of free rotation and diffusion is neither, and blocks do not
/// show the scatter of the free part, which is the same in all of them.
void CorrelationResults::drop_meaningless(std::size_t group, Correlations& results) const {
  const bool all_unturned = unturned(group);
  if (!all_unturned && !(group == kAll && some_unturned())) return;
  const MissingReason reason = all_unturned ? MissingReason::meaningless : MissingReason::meaningless_in_part;
  const auto drop = [reason](const Gap& gap, Estimate& e) {
    if (!gap) e = Estimate::none({reason});
  };
  for (Estimate* e : {&results.D_rot, &results.D_rot_body}) drop(measured_.gaps.rotations, *e);
  for (Estimate* e : {&results.tau_C2, &results.beta_C2}) drop(measured_.gaps.turning, *e);
  results.window_C2 = {};
  for (Estimate& e : results.D_rot_axis) {
    if (three_axes(group)) drop(measured_.gaps.rotations, e);
  }
  const auto drop_error = [](Estimate& e) { e.error = kNothing; };
  for (LagRow& row : results.lags) {
    for (Estimate* e : {&row.rot_msd, &row.rot_msd_body, &row.c1, &row.c2, &row.wacf}) drop_error(*e);
    for (auto* axes : {&row.rot_msd_axis, &row.c1_axis, &row.c2_axis}) {
      std::for_each(axes->begin(), axes->end(), drop_error);
    }
  }
  for (Estimate* e : {&results.t_C2_1overe, &results.w2}) drop_error(*e);
  std::for_each(results.t_C2_1overe_axis.begin(), results.t_C2_1overe_axis.end(), drop_error);
}

// ---- Results

LagRow CorrelationResults::lag_row(std::size_t lag, std::size_t group, const DirectedResults& directed) const {
  const auto estimate = [&](const Gap& gap, const auto& value) {
    if (gap) return Estimate::none({*gap});
    return averages_.with_block_error(measured_.lags[lag], [&](const Block* one) {
      const LagSums sums = averages_.sums_at(lag, group, {one, nullptr});
      return sums.count > 0 ? value(sums) / sums.count : kNothing;
    });
  };
  const Gaps& gaps = measured_.gaps;
  LagRow row{};
  row.lag = measured_.lags[lag];
  row.msd = estimate(gaps.displacements, [](const LagSums& s) { return s.msd; });
  row.rot_msd = estimate(gaps.rotations, [](const LagSums& s) { return s.rot_msd; });
  row.rot_msd_body = estimate(gaps.rotations, [](const LagSums& s) { return s.rot_msd_body; });
  row.c1 = estimate(gaps.turning, [](const LagSums& s) { return s.c1; });
  row.c2 = estimate(gaps.turning, [](const LagSums& s) { return s.c2; });
  row.vacf = estimate(gaps.velocity_correlations, [](const LagSums& s) { return s.vacf; });
  row.wacf = estimate(gaps.rotations, [](const LagSums& s) { return s.wacf; });
  row.alpha2 = estimate(gaps.displacements, [](const LagSums& s) { return alpha2(s) * s.count; });
  for (std::size_t k = 0; k < measured_.options.wave_numbers.size(); ++k) {
    row.f_self.push_back(estimate(gaps.displacements, [k](const LagSums& s) { return s.f_self[k]; }));
  }
  for (std::size_t k = 0; group == kAll && k < measured_.options.wave_numbers.size(); ++k) {
    if (!measured_.options.collective) break;
    row.f_collective.push_back(estimate({}, [k](const LagSums& s) { return s.f_collective[k]; }));
  }
  row.overlap = estimate(gaps.overlap, [](const LagSums& s) { return s.overlap; });
  row.chi4 =
      gaps.overlap ? Estimate::none({*gaps.overlap}) : averages_.with_jackknife_error(row.lag, [&](Selection part) {
        return chi4_of(group, averages_.sums_at(lag, group, part));
      });
  directed.add_to(row, lag, group);
  if (!three_axes(group)) return row;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    row.rot_msd_axis[at] = estimate(gaps.rotations, [axis](const LagSums& s) { return s.rot_msd_axis[axis]; });
    row.c1_axis[at] = estimate(gaps.turning, [axis](const LagSums& s) { return s.c1_axis[axis]; });
    row.c2_axis[at] = estimate(gaps.turning, [axis](const LagSums& s) { return s.c2_axis[axis]; });
  }
  return row;
}

void CorrelationResults::add_lags(std::size_t group, Correlations& results) const {
  const DirectedResults directed(averages_, turned());
  for (std::size_t k = 0; k < measured_.lags.size(); ++k) {
    if (averages_.sums_at(k, group).count > 0) results.lags.push_back(lag_row(k, group, directed));
  }
}

void CorrelationResults::add_diffusion(std::size_t group, Correlations& results) const {
  const Gaps& gaps = measured_.gaps;
  const double components = mean_rotation_axes(group);
  const Reach turn = reach_of_rotation(components);
  if (measured_.grid.known()) {
    const auto msd = [](const LagSums& s) { return s.msd; };
    // Curves leave out the same lags, those without data, so that an index is the same lag in both.
    const std::size_t first = first_of_fit(averages_.curve(group, {}, msd));
    const Curve non_gaussian_at = averages_.curve(group, {}, [](const LagSums& s) { return alpha2(s) * s.count; });
    const double non_gaussian = first < non_gaussian_at.y.size() ? non_gaussian_at.y[first] : 0;
    const double q = structure_.first_wave_number(group);
    const Reach move = reach_of_translation(q, non_gaussian);
    results.D_trans = diffusion_estimate(averages_, gaps.displacements, group, 6, move, msd);
    DirectedResults(averages_, turned()).add_to(results, group, q);
  }
  results.D_rot = diffusion_estimate(averages_, gaps.rotations, group, 2 * components, turn,
                                     [](const LagSums& s) { return s.rot_msd; });
  results.D_rot_body = diffusion_estimate(averages_, gaps.rotations, group, 2 * components, turn,
                                          [](const LagSums& s) { return s.rot_msd_body; });
  if (!gaps.displacements) results.window_D = {kFitFrom * averages_.longest_lag(), averages_.longest_lag()};
}

void CorrelationResults::add_decays(std::size_t group, Correlations& results) const {
  const Gaps& gaps = measured_.gaps;
  const auto c2 = [](const LagSums& s) { return s.c2; };
  results.t_C2_1overe = decay_time_estimate(gaps.turning, group, c2);
  fit(gaps.turning, group, c2, results.tau_C2, results.beta_C2, results.window_C2);
  if (measured_.options.wave_numbers.empty() && !gaps.displacements) return;
  const std::vector<double>& q = measured_.options.wave_numbers;
  // Where displacements are not known, nor are wave numbers: the reason still stands.
  for (std::size_t k = 0; k < std::max<std::size_t>(1, q.size()); ++k) {
    const auto f_self = [k](const LagSums& s) { return s.f_self[k]; };
    ScatteringDecay decay{};
    decay.q = k < q.size() ? q[k] : kNothing;
    decay.t_1overe = decay_time_estimate(gaps.displacements, group, f_self);
    fit(gaps.displacements, group, f_self, decay.tau, decay.beta, decay.window);
    results.decays_F.push_back(decay);
  }
  const ScatteringDecay& first = results.decays_F[0];
  results.t_F_1overe = first.t_1overe;
  results.tau_F = first.tau;
  results.beta_F = first.beta;
  results.window_F = first.window;
  if (q.empty()) results.decays_F.clear();
}

/// Adds the decays of F / S, which all bodies have.
void CorrelationResults::add_collective_decays(std::size_t group, Correlations& results) const {
  if (!measured_.options.collective || group != kAll) return;
  for (std::size_t k = 0; k < measured_.options.wave_numbers.size(); ++k) {
    const auto f = [k](const LagSums& s) { return s.f_collective[k]; };
    ScatteringDecay decay{};
    decay.q = measured_.options.wave_numbers[k];
    Gap gap;
    if (!has_wave_vectors(measured_.grid.box, decay.q)) gap = MissingReason::no_wave_vector;
    decay.t_1overe = decay_time_estimate(gap, group, f);
    fit(gap, group, f, decay.tau, decay.beta, decay.window);
    results.decays_collective.push_back(decay);
  }
}

/// Adds the plateau of the MSD.
void CorrelationResults::add_cage(std::size_t group, Correlations& results) const {
  const auto msd = [](const LagSums& s) { return s.msd; };
  if (const auto gap = measured_.gaps.displacements) {
    results.msd_plateau = Estimate::none({*gap});
    return;
  }
  const Curve curve = averages_.curve(group, {}, msd);
  const Flattest flattest = flattest_of(curve);
  if (std::isnan(flattest.exponent)) return;
  if (flattest.exponent > kCaged) {
    results.msd_plateau = Estimate::none({MissingReason::no_cage, flattest.exponent});
    return;
  }
  for (const LagRow& row : results.lags) {
    if (row.lag == curve.t[flattest.lag]) results.msd_plateau = row.msd;
  }
}

/// Returns the density of displacements in a bin of this volume, at a lag of hove_lags.
Estimate CorrelationResults::van_hove(std::size_t h, std::size_t bin, double volume, std::size_t group) const {
  const std::size_t lag = measured_.hove_lags[h];
  const std::size_t groups = measured_.ranges.size();
  const double bodies = group == kAll ? measured_.options.number : measured_.ranges[group].size();
  return averages_.with_block_error(measured_.lags[lag], [&](const Block* one) {
    double number = 0;
    for (const Block& block : measured_.blocks) {
      if (one != nullptr && &block != one) continue;
      for (std::size_t g = 0; g < groups; ++g) {
        if (group == kAll || g == group) number += block.displaced[(h * groups + g) * kHoveBins + bin];
      }
    }
    const double origins = averages_.sums_at(lag, group, {one, nullptr}).count;
    return origins > 0 ? number / (origins * bodies * volume) : kNothing;
  });
}

/// Adds the van Hove function.
void CorrelationResults::add_displacements(std::size_t group, Correlations& results) const {
  if (!measured_.grid.known() || measured_.gaps.displacements) return;
  const double width = kHoveWidth * measured_.grid.length;
  std::vector<std::size_t> reached;
  for (std::size_t h = 0; h < measured_.hove_lags.size(); ++h) {
    if (!(averages_.sums_at(measured_.hove_lags[h], group).count > 0)) continue;
    reached.push_back(h);
    results.displacement_lags.push_back(measured_.lags[measured_.hove_lags[h]]);
  }
  for (std::size_t bin = 0; bin < kHoveBins; ++bin) {
    const auto from = static_cast<double>(bin);
    const double volume = 4 * std::numbers::pi / 3 * (std::pow(from + 1, 3) - std::pow(from, 3)) * std::pow(width, 3);
    DisplacementRow row{(from + 0.5) * width, {}};
    for (const std::size_t h : reached) row.G.push_back(van_hove(h, bin, volume, group));
    results.displacements.push_back(row);
  }
}

/// N (<Q^2> - <Q>^2); NaN for a single origin, which has no scatter.
double CorrelationResults::chi4_of(std::size_t group, const LagSums& sums) const {
  if (!(sums.count > 1)) return kNothing;
  const double bodies = group == kAll ? measured_.options.number : measured_.ranges[group].size();
  const double mean = sums.overlap / sums.count;
  return bodies * std::max(0.0, sums.overlap2 / sums.count - mean * mean);
}

/// Adds the maximum of chi_4.
void CorrelationResults::add_heterogeneity(std::size_t group, Correlations& results) const {
  if (const auto gap = measured_.gaps.overlap) {
    results.chi4_peak = results.t_chi4 = Estimate::none({*gap});
    return;
  }
  const LagRow* highest = nullptr;
  for (const LagRow& row : results.lags) {
    if (std::isfinite(row.chi4.value) && (highest == nullptr || row.chi4.value > highest->chi4.value)) highest = &row;
  }
  if (highest == nullptr) return;
  if (highest == &results.lags.back()) {
    results.chi4_peak = results.t_chi4 = Estimate::none({MissingReason::still_growing});
    return;
  }
  results.chi4_peak = highest->chi4;
  results.t_chi4 = averages_.with_jackknife_error(highest->lag, [&](Selection part) {
    const Curve curve = averages_.curve(group, part, [&](const LagSums& s) { return s.count * chi4_of(group, s); });
    std::size_t at = curve.t.size();
    for (std::size_t k = 0; k < curve.t.size(); ++k) {
      if (std::isfinite(curve.y[k]) && (at == curve.t.size() || curve.y[k] > curve.y[at])) at = k;
    }
    return at < curve.t.size() ? curve.t[at] : kNothing;
  });
  // The maximum lies anywhere between the middles of the neighbouring intervals.
  const double before = highest == results.lags.data() ? highest->lag : highest[-1].lag;
  const double width = 0.5 * (highest[1].lag - before);
  results.t_chi4.error = std::hypot(results.t_chi4.error, width / std::sqrt(12.0));
}

void CorrelationResults::add_axes(std::size_t group, Correlations& results) const {
  const Gaps& gaps = measured_.gaps;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    Estimate& D = results.D_rot_axis[at];
    Estimate& t = results.t_C2_1overe_axis[at];
    D = Estimate::none({gaps.rotations.value_or(MissingReason::no_such_axis)});
    t = Estimate::none({gaps.turning.value_or(MissingReason::no_such_axis)});
    if (!three_axes(group)) continue;
    D = diffusion_estimate(averages_, gaps.rotations, group, 2, reach_of_rotation(1),
                           [axis](const LagSums& s) { return s.rot_msd_axis[axis]; });
    t = decay_time_estimate(gaps.turning, group, [axis](const LagSums& s) { return s.c2_axis[axis]; });
  }
}

Correlations CorrelationResults::of_group(std::size_t group) const {
  const Gaps& gaps = measured_.gaps;
  Correlations results;
  add_lags(group, results);
  add_diffusion(group, results);
  add_decays(group, results);
  add_collective_decays(group, results);
  add_cage(group, results);
  add_heterogeneity(group, results);
  add_displacements(group, results);
  add_axes(group, results);
  results.v2 = gaps.velocities ? Estimate::none({*gaps.velocities})
                               : averages_.frame_mean([&](const Block& b) { return b.sums_of(group).v2; });
  results.w2 = gaps.rotations ? Estimate::none({*gaps.rotations})
                              : averages_.frame_mean([&](const Block& b) { return b.sums_of(group).w2; });
  drop_meaningless(group, results);
  structure_.add_to(results, group);
  return results;
}

}  // namespace ed::internal
