#include "observables/curves.h"
#include "observables/measured.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kAll = static_cast<std::size_t>(-1);  ///< instead of a group: all bodies

/// By what the standard error of block averages must be multiplied for a correlation at `lag`: the origins of a block
/// lie in one `length` of time, but look ahead by the lag, so that neighbouring blocks share data.
///
/// For displacements of a Brownian particle the averages over the origins of two neighbouring blocks have the
/// correlation coefficient rho = f / (8 - 2 f), f = lag / length <= 1 (the variance is the integral of
/// (1 - s/length) (1 - s/lag)^2 over the offset s, the covariance that of s (1 - s/lag)^2), and the mean of many blocks
/// then has the variance (1 + 2 rho) times that of independent ones: at most 4/3.
double shared_data_factor(double lag, double length) {
  const double f = std::min(1.0, lag / length);
  return std::sqrt(1 + 2 * f / (8 - 2 * f));
}

/// Blocks whose C2 at the longest lag differ by no more are of bodies that nothing turns: rounding leaves 1e-15 to
/// 1e-12, one body in a million that a collision has turned 1e-7.
constexpr double kUnturned = 1e-11;

double alpha2(const LagSums& s) {
  return 3 * s.r4 * s.count / (5 * s.msd * s.msd) - 1;
}

/// The blocks that a value is made of: all of them, only one, or all but one.
struct Selection {
  const Block* only = nullptr;
  const Block* without = nullptr;

  bool takes(const Block& block) const { return (only == nullptr || &block == only) && &block != without; }
};

/// Results of the blocks.
class Evaluation {
 public:
  Evaluation(const Measured& measured, const Totals& totals, std::optional<double> fit_from)
      : measured_(measured), totals_(totals) {
    if (measured.grid.known()) wave_vectors_.emplace(wave_vectors_of(measured.grid));
    for (const Block& block : measured.blocks) {
      if (2 * block.origins > measured.origins_per_block && block.end.time > block.begin.time) full_.push_back(&block);
    }
    fit_from_ = fit_from.value_or(kBallisticCollisions / collision_rate({}, totals));
  }

  Results results() const;

 private:
  /// Collisions of a body and unit of time.
  double collision_rate(const Totals& begin, const Totals& end) const {
    return 2 * (end.collisions - begin.collisions) / (measured_.options.number * (end.time - begin.time));
  }

  Estimate collision_rate(std::size_t group) const;
  BlockRow block_row(const Block& block) const;
  Matrix3d pressure(const Totals& begin, const Totals& end, double kT, const Matrix3d& kinetic) const;
  LagSums sums_at(std::size_t lag, std::size_t group, Selection selection) const;
  double first_wave_number() const;
  double first_wave_number(std::size_t group) const;
  bool three_axes(std::size_t group) const;
  bool unturned(std::size_t group) const;
  bool some_unturned() const;
  double mean_rotation_axes(std::size_t group) const;

  /// Mean over the origins of a selection, against lag.
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

  /// The value from all data, with the standard error of the values from each block, for a quantity that depends on
  /// correlations up to `lag`.
  template <class Of>
  Estimate with_block_error(double lag, const Of& of) const {
    Estimate all{of(nullptr), kNothing};
    if (!std::isfinite(all.value)) return {};
    std::vector<double> values;
    for (const Block* block : full_) {
      const double value = of(block);
      if (std::isfinite(value)) values.push_back(value);
    }
    const double length = measured_.origins_per_block * measured_.spacing;
    all.error = shared_data_factor(lag, length) * mean_of_blocks(values).error;
    return all;
  }

  /// Value from all data with its standard error, for a quantity that a single block may be too short for: where some
  /// block has none, the error is that of the jackknife, of which no block is left out.
  template <class Of>
  Estimate with_error_of_all_blocks(double lag, const Of& of) const {
    const auto lacking = [&](const Block* block) { return !std::isfinite(of(Selection{block, nullptr})); };
    if (std::none_of(full_.begin(), full_.end(), lacking)) {
      return with_block_error(lag, [&](const Block* block) { return of(Selection{block, nullptr}); });
    }
    Estimate all{of(Selection{}), kNothing};
    if (full_.size() < 2) return all;
    std::vector<double> values;
    for (const Block* block : full_) values.push_back(of(Selection{nullptr, block}));
    const double length = measured_.origins_per_block * measured_.spacing;
    // sqrt((n - 1) / n sum of squares), against sqrt(1 / (n (n - 1)) sum of squares); NaN if a value is.
    all.error =
        shared_data_factor(lag, length) * (static_cast<double>(values.size()) - 1) * mean_of_blocks(values).error;
    return all;
  }

  /// Diffusion coefficient of displacements. Whether there is one is decided on all data; blocks then only give its
  /// error.
  template <class Value>
  Estimate diffusion_estimate(std::size_t group, double divisor, const Reach& reach, const Value& value) const {
    const auto complete = [&](const Curve& c) { return !c.t.empty() && c.t.back() >= measured_.lags.back(); };
    const Curve all = curve(group, {}, value);
    if (all.t.empty()) return {};
    if (!complete(all)) return Estimate::none({MissingReason::lags_too_short});
    if (const auto missing = why_not_diffusive(all, reach)) return Estimate::none(*missing);
    return with_block_error(measured_.lags.back(), [&](const Block* block) {
      const Curve part = curve(group, {block, nullptr}, value);
      // A block whose origins have not reached the longest lag would be fitted over another window.
      return complete(part) ? final_slope(part) / divisor : kNothing;
    });
  }

  template <class Value>
  Estimate decay_time_estimate(std::size_t group, const Value& value) const {
    if (const auto missing = why_no_decay_time(curve(group, {}, value))) return Estimate::none(*missing);
    return with_error_of_all_blocks(measured_.lags.back(),
                                    [&](Selection part) { return decay_time(curve(group, part, value)); });
  }

  /// tau, beta and the window of a stretched exponential.
  template <class Value>
  void fit(std::size_t group, const Value& value, Estimate& tau, Estimate& beta, FitWindow& window) const {
    const Curve all = curve(group, {}, value);
    if (const auto missing = why_no_fit(all, fit_from_)) {
      tau = beta = Estimate::none(*missing);
      return;
    }
    const auto estimate = [&](double StretchedExponential::*member) {
      return with_error_of_all_blocks(measured_.lags.back(), [&](Selection part) {
        const auto found = fit_decay(curve(group, part, value), fit_from_);
        return found ? found->fit.*member : kNothing;
      });
    };
    tau = estimate(&StretchedExponential::tau);
    beta = estimate(&StretchedExponential::beta);
    if (const auto found = fit_decay(all, fit_from_)) window = {found->from, found->to};
  }

  /// Mean of one number of a frame over all frames, with the error of the means of blocks.
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

  /// Of what `sums` picks of a block.
  template <class Sums>
  Director director(const Sums& sums) const;

  /// Sums of the structure; of one block, or (nullptr) of all.
  StructureSums structure_sums(std::size_t part, const Block* one, double& frames) const;
  void add_pairs(std::size_t part, double number, Correlations& results) const;
  void add_structure(std::size_t part, Correlations& results) const;

  LagRow lag_row(std::size_t lag, std::size_t group) const;
  void add_diffusion(std::size_t group, Correlations& results) const;
  void add_axes(std::size_t group, Correlations& results) const;
  Correlations correlations(std::size_t group) const;
  GroupResults group_results(std::size_t group) const;
  void add_blocks(Results& results) const;
  void add_pressure(Results& results) const;

  const Measured& measured_;
  const Totals& totals_;
  double fit_from_ = kNothing;               ///< the lag from which decays are fitted
  std::vector<const Block*> full_;           ///< that are complete, or at least half so: what errors are made of
  std::optional<WaveVectors> wave_vectors_;  ///< of S(q), if there is a box
};

// ---- Blocks

BlockRow Evaluation::block_row(const Block& block) const {
  const int number = measured_.options.number;
  const double time = block.end.time - block.begin.time;
  BlockRow row{};
  row.begin = block.begin.time;
  row.end = block.end.time;
  row.collision_rate = collision_rate(block.begin, block.end);
  row.translational_kT = block.all.translational_kT / block.frames;
  row.rotational_kT = block.all.rotational_kT / block.frames;
  row.S = block.all.S / block.frames;
  row.Z = 1 + (block.end.virial - block.begin.virial) / (3 * number * row.translational_kT * time);
  row.director = director_of(block.all.order);
  row.pressure = pressure(block.begin, block.end, row.translational_kT, block.kinetic / block.frames);
  return row;
}

/// Of the bodies of one group.
Estimate Evaluation::collision_rate(std::size_t group) const {
  if (totals_.collisions_of.empty() || !(totals_.time > 0)) return {};
  const auto bodies = static_cast<double>(measured_.ranges[group].size());
  std::vector<double> values;
  for (const Block* block : full_) {
    const double met = block->end.collisions_of[group] - block->begin.collisions_of[group];
    values.push_back(met / (bodies * (block->end.time - block->begin.time)));
  }
  return {totals_.collisions_of[group] / (bodies * totals_.time), mean_of_blocks(values).error};
}

Matrix3d Evaluation::pressure(const Totals& begin, const Totals& end, double kT, const Matrix3d& kinetic) const {
  const Matrix3d virial = end.virial_tensor - begin.virial_tensor;
  const double share = 2 * measured_.options.number * kT * (end.time - begin.time);
  return kinetic + (virial + virial.transpose()) / share;
}

void Evaluation::add_blocks(Results& results) const {
  std::vector<double> rate, Z;
  for (const Block* block : full_) {
    const BlockRow row = block_row(*block);
    results.blocks.push_back(row);
    rate.push_back(row.collision_rate);
    Z.push_back(row.Z);
  }
  results.translational_kT = frame_mean([](const Block& b) { return b.all.translational_kT; });
  results.rotational_kT = frame_mean([](const Block& b) { return b.all.rotational_kT; });
  results.S = frame_mean([](const Block& b) { return b.all.S; });
  results.director = director([](const Block& b) -> const FrameSums& { return b.all; });
  if (totals_.time > 0) results.collision_rate = results.Z = Estimate::none({MissingReason::no_collisions});
  if (!(totals_.collisions > 0 && totals_.time > 0)) return;
  const int number = measured_.options.number;
  results.collision_rate = {collision_rate({}, totals_), mean_of_blocks(rate).error};
  if (results.blocks.empty()) return;
  results.Z = {1 + totals_.virial / (3 * number * results.translational_kT.value * totals_.time),
               mean_of_blocks(Z).error};
  add_pressure(results);
}

void Evaluation::add_pressure(Results& results) const {
  Matrix3d kinetic = Matrix3d::Zero();
  double frames = 0;
  for (const Block& block : measured_.blocks) {
    kinetic += block.kinetic;
    frames += block.frames;
  }
  results.pressure.value = pressure({}, totals_, results.translational_kT.value, kinetic / frames);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      std::vector<double> values;
      for (const BlockRow& row : results.blocks) values.push_back(row.pressure(i, j));
      results.pressure.error(i, j) = mean_of_blocks(values).error;
    }
  }
}

template <class Sums>
Director Evaluation::director(const Sums& sums) const {
  Director result;
  if (full_.empty()) return result;
  Matrix3d all = Matrix3d::Zero();
  for (const Block* block : full_) all += sums(*block).order;
  result.axis = director_of(all);
  const auto n = static_cast<double>(full_.size());
  if (full_.size() < 2) return result;
  double squares = 0;
  for (const Block* block : full_) squares += result.axis.cross(director_of(sums(*block).order)).squaredNorm();
  result.error = std::sqrt(squares / (n * (n - 1)));
  return result;
}

// ---- Structure

StructureSums Evaluation::structure_sums(std::size_t part, const Block* one, double& frames) const {
  const std::vector<Block>& blocks = measured_.blocks;
  StructureSums sums = one != nullptr ? one->structure[part] : blocks[0].structure[part];
  frames = one != nullptr ? one->structure_frames : blocks[0].structure_frames;
  for (std::size_t k = 1; k < blocks.size() && one == nullptr; ++k) {
    sums.add(blocks[k].structure[part]);
    frames += blocks[k].structure_frames;
  }
  return sums;
}

void Evaluation::add_pairs(std::size_t part, double number, Correlations& results) const {
  const StructureGrid& grid = measured_.grid;
  const double width = grid.reach() / static_cast<double>(grid.bins());
  const double density = 0.5 * number * (number - 1) / (grid.box * grid.box * grid.box);
  for (std::size_t k = 0; k < grid.bins(); ++k) {
    const double inner = width * static_cast<double>(k);
    const double outer = inner + width;
    const double shell = 4 * std::numbers::pi / 3 * (outer * outer * outer - inner * inner * inner);
    const Estimate g = with_block_error(0, [&](const Block* one) {
      double frames = 0;
      const StructureSums sums = structure_sums(part, one, frames);
      return sums.pairs[k] / (frames * density * shell);
    });
    const Estimate g2 = with_block_error(0, [&](const Block* one) {
      double frames = 0;
      const StructureSums sums = structure_sums(part, one, frames);
      return sums.pairs[k] > 0 ? sums.p2[k] / sums.pairs[k] : kNothing;
    });
    results.pairs.push_back({0.5 * (inner + outer), g, g2});
  }
}

void Evaluation::add_structure(std::size_t part, Correlations& results) const {
  const std::vector<double>& q = wave_vectors_->wave_numbers();
  const auto S_of = [&](const Block* one) {
    double frames = 0;
    std::vector<double> S = structure_sums(part, one, frames).S;
    for (double& value : S) value /= frames;
    return S;
  };
  for (std::size_t k = 0; k < q.size(); ++k) {
    if (q[k] > 0) results.structure.push_back({q[k], with_block_error(0, [&](const Block* b) { return S_of(b)[k]; })});
  }
  const double length = measured_.grid.length;
  results.q_peak = with_block_error(0, [&](const Block* one) { return first_peak(q, S_of(one), length).q; });
  results.S_peak = with_block_error(0, [&](const Block* one) { return first_peak(q, S_of(one), length).S; });
}

// ---- Correlations

/// Sums over the bodies of a group (kAll: of all) at one lag, in the blocks of a selection.
LagSums Evaluation::sums_at(std::size_t lag, std::size_t group, Selection selection) const {
  LagSums sums;
  const std::size_t groups = measured_.ranges.size();
  for (const Block& block : measured_.blocks) {
    if (!selection.takes(block)) continue;
    for (std::size_t g = 0; g < groups; ++g) {
      if (group != kAll && g != group) continue;
      sums.add(block.lags[lag * groups + g], group == kAll ? measured_.weights[g] : 1);
    }
  }
  return sums;
}

/// Wave number of the first peak of S(q) of all bodies, as a run chooses it; it tells how far bodies have to move to
/// leave their neighbours. Frames of a block hold much the same configuration and count as one.
double Evaluation::first_wave_number() const {
  const StructureGrid& grid = measured_.grid;
  const double number = measured_.options.number;
  const double packing = number * 4 * std::numbers::pi / 3 * std::pow(grid.length / grid.box, 3);
  // Without sizes: the mean distance of bodies. So too where the sizes are none, as bodies would fill more than space.
  if (!measured_.length_known || packing >= 1) return 2 * std::numbers::pi * std::cbrt(number) / grid.box;
  double frames = 0;
  std::vector<double> S = structure_sums(0, nullptr, frames).S;
  for (double& value : S) value /= frames;
  return likely_peak(*wave_vectors_, S, static_cast<double>(measured_.blocks.size()), grid, packing);
}

/// First wave number for a group: that of all bodies. Where its own S(q) has a clear peak at a smaller wave number, as
/// that of large bodies that cage each other, it is that one.
double Evaluation::first_wave_number(std::size_t group) const {
  const double of_all = first_wave_number();
  if (group == kAll || measured_.ranges.size() == 1 || !measured_.length_known) return of_all;
  double frames = 0;
  std::vector<double> S = structure_sums(group + 1, nullptr, frames).S;
  for (double& value : S) value /= frames;
  const auto own = clear_peak(*wave_vectors_, S, static_cast<double>(measured_.blocks.size()), measured_.grid.length);
  return own ? std::min(of_all, *own) : of_all;
}

bool Evaluation::three_axes(std::size_t group) const {
  const std::vector<BodyRange>& ranges = measured_.ranges;
  return group == kAll ? ranges.size() == 1 && ranges[0].three_axes : ranges[group].three_axes;
}

/// Whether nothing turns the bodies, as with spheres, and in a gas in which nothing has met: all blocks then hold one
/// and the same motion, and their scatter, which is rounding, is no error.
bool Evaluation::unturned(std::size_t group) const {
  std::vector<double> c2;
  for (const Block* block : full_) {
    const Curve all = curve(group, {block, nullptr}, [](const LagSums& s) { return s.c2; });
    if (!all.t.empty() && all.t.back() == measured_.lags.back()) c2.push_back(all.y.back());
  }
  if (c2.size() < 2) return false;
  const auto [least, most] = std::minmax_element(c2.begin(), c2.end());
  return *most - *least < kUnturned;
}

bool Evaluation::some_unturned() const {
  for (std::size_t g = 0; g < measured_.ranges.size(); ++g) {
    if (unturned(g)) return true;
  }
  return false;
}

/// Removes rotational diffusion and its fits, which mean nothing then. Correlations, and the lag at which C2 is 1/e,
/// are right, but no error of them is known.
void drop_rotational_errors(Correlations& results, bool three_axes) {
  const Estimate none = Estimate::none({MissingReason::meaningless});
  for (Estimate* e : {&results.D_rot, &results.D_rot_body, &results.tau_C2, &results.beta_C2}) *e = none;
  results.window_C2 = {};
  if (three_axes) results.D_rot_axis.fill(none);
  const auto drop = [](Estimate& e) { e.error = kNothing; };
  for (LagRow& row : results.lags) {
    for (Estimate* e : {&row.rot_msd, &row.rot_msd_body, &row.c1, &row.c2, &row.wacf}) drop(*e);
    for (auto* axes : {&row.rot_msd_axis, &row.c1_axis, &row.c2_axis}) {
      std::for_each(axes->begin(), axes->end(), drop);
    }
  }
  for (Estimate* e : {&results.t_C2_1overe, &results.w2}) drop(*e);
  std::for_each(results.t_C2_1overe_axis.begin(), results.t_C2_1overe_axis.end(), drop);
}

double Evaluation::mean_rotation_axes(std::size_t group) const {
  const std::vector<BodyGroup>& groups = measured_.options.groups;
  if (group != kAll) return groups[group].rotation_axes;
  double mean = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) mean += measured_.weights[g] * groups[g].rotation_axes;
  return mean;
}

LagRow Evaluation::lag_row(std::size_t lag, std::size_t group) const {
  const auto estimate = [&](const auto& value) {
    return with_block_error(measured_.lags[lag], [&](const Block* one) {
      const LagSums sums = sums_at(lag, group, {one, nullptr});
      return sums.count > 0 ? value(sums) / sums.count : kNothing;
    });
  };
  LagRow row{};
  row.lag = measured_.lags[lag];
  row.msd = estimate([](const LagSums& s) { return s.msd; });
  row.rot_msd = estimate([](const LagSums& s) { return s.rot_msd; });
  row.rot_msd_body = estimate([](const LagSums& s) { return s.rot_msd_body; });
  row.c1 = estimate([](const LagSums& s) { return s.c1; });
  row.c2 = estimate([](const LagSums& s) { return s.c2; });
  row.vacf = estimate([](const LagSums& s) { return s.vacf; });
  row.wacf = estimate([](const LagSums& s) { return s.wacf; });
  row.alpha2 = estimate([](const LagSums& s) { return alpha2(s) * s.count; });
  for (std::size_t k = 0; k < measured_.options.wave_numbers.size(); ++k) {
    row.f_self.push_back(estimate([k](const LagSums& s) { return s.f_self[k]; }));
  }
  if (!three_axes(group)) return row;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    row.rot_msd_axis[at] = estimate([axis](const LagSums& s) { return s.rot_msd_axis[axis]; });
    row.c1_axis[at] = estimate([axis](const LagSums& s) { return s.c1_axis[axis]; });
    row.c2_axis[at] = estimate([axis](const LagSums& s) { return s.c2_axis[axis]; });
  }
  return row;
}

void Evaluation::add_axes(std::size_t group, Correlations& results) const {
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    results.D_rot_axis[at] =
        diffusion_estimate(group, 2, reach_of_rotation(1), [axis](const LagSums& s) { return s.rot_msd_axis[axis]; });
    results.t_C2_1overe_axis[at] = decay_time_estimate(group, [axis](const LagSums& s) { return s.c2_axis[axis]; });
  }
}

void Evaluation::add_diffusion(std::size_t group, Correlations& results) const {
  const double components = mean_rotation_axes(group);
  const Reach turn = reach_of_rotation(components);
  if (measured_.grid.known()) {
    const auto msd = [](const LagSums& s) { return s.msd; };
    // Curves leave out the same lags, those without data, so that an index is the same lag in both.
    const std::size_t first = first_of_fit(curve(group, {}, msd));
    const Curve non_gaussian_at = curve(group, {}, [](const LagSums& s) { return alpha2(s) * s.count; });
    const double non_gaussian = first < non_gaussian_at.y.size() ? non_gaussian_at.y[first] : 0;
    results.D_trans = diffusion_estimate(group, 6, reach_of_translation(first_wave_number(group), non_gaussian), msd);
  }
  results.D_rot = diffusion_estimate(group, 2 * components, turn, [](const LagSums& s) { return s.rot_msd; });
  results.D_rot_body = diffusion_estimate(group, 2 * components, turn, [](const LagSums& s) { return s.rot_msd_body; });
  results.window_D = {kFitFrom * measured_.lags.back(), measured_.lags.back()};
}

Correlations Evaluation::correlations(std::size_t group) const {
  Correlations results;
  const auto c2 = [](const LagSums& s) { return s.c2; };
  const auto f_self = [](const LagSums& s) { return s.f_self[0]; };
  for (std::size_t k = 0; k < measured_.lags.size(); ++k) {
    LagRow row = lag_row(k, group);
    if (std::isfinite(row.msd.value)) results.lags.push_back(std::move(row));
  }
  add_diffusion(group, results);
  results.t_C2_1overe = decay_time_estimate(group, c2);
  fit(group, c2, results.tau_C2, results.beta_C2, results.window_C2);
  if (!measured_.options.wave_numbers.empty()) {
    results.t_F_1overe = decay_time_estimate(group, f_self);
    fit(group, f_self, results.tau_F, results.beta_F, results.window_F);
  }
  results.D_rot_axis.fill(Estimate::none({MissingReason::no_such_axis}));
  results.t_C2_1overe_axis = results.D_rot_axis;
  if (three_axes(group)) add_axes(group, results);
  const auto sums = [group](const Block& b) -> const FrameSums& { return group == kAll ? b.all : b.groups[group]; };
  results.v2 = frame_mean([&](const Block& b) { return sums(b).v2; });
  results.w2 = frame_mean([&](const Block& b) { return sums(b).w2; });
  if (unturned(group)) {
    drop_rotational_errors(results, three_axes(group));
  } else if (group == kAll && some_unturned()) {
    // The mean of free rotation and diffusion is neither.
    results.D_rot = results.D_rot_body = Estimate::none({MissingReason::meaningless});
  }
  if (!measured_.grid.known()) return results;
  const std::size_t part = group == kAll || measured_.ranges.size() == 1 ? 0 : group + 1;
  add_pairs(part, group == kAll ? measured_.options.number : measured_.ranges[group].size(), results);
  add_structure(part, results);
  return results;
}

GroupResults Evaluation::group_results(std::size_t group) const {
  GroupResults results;
  static_cast<Correlations&>(results) = correlations(group);
  results.collision_rate = collision_rate(group);
  results.S = frame_mean([group](const Block& b) { return b.groups[group].S; });
  results.director = director([group](const Block& b) -> const FrameSums& { return b.groups[group]; });
  results.translational_kT = frame_mean([group](const Block& b) { return b.groups[group].translational_kT; });
  results.rotational_kT = frame_mean([group](const Block& b) { return b.groups[group].rotational_kT; });
  for (int axis = 0; axis < 3; ++axis) {
    results.axis_kT[static_cast<std::size_t>(axis)] =
        frame_mean([group, axis](const Block& b) { return b.groups[group].axis_kT[axis]; });
  }
  return results;
}

Results Evaluation::results() const {
  Results results;
  results.duration = totals_.time;
  add_blocks(results);
  static_cast<Correlations&>(results) = correlations(kAll);
  for (std::size_t g = 0; g < measured_.ranges.size(); ++g) results.groups.push_back(group_results(g));
  return results;
}

}  // namespace

Results results_of(const Measured& measured, const Totals& totals, std::optional<double> fit_from) {
  return Evaluation(measured, totals, fit_from).results();
}

}  // namespace ed::internal
