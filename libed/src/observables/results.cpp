#include "observables/block_averages.h"
#include "observables/correlation_results.h"
#include "observables/measured.h"
#include "observables/order/directed_results.h"
#include "observables/order/phase_results.h"
#include "observables/structure_results.h"

#include <algorithm>
#include <cmath>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;

/// Results of all bodies and of each group.
class ResultsOf {
 public:
  ResultsOf(const Measured& measured, const Totals& totals, std::optional<double> fit_from)
      : measured_(measured),
        totals_(totals),
        averages_(measured),
        structure_(averages_),
        correlations_(averages_, structure_,
                      fit_from.value_or(kBallisticCollisions / collision_rate({}, totals, measured.options.number))) {}

  Results results() const;

 private:
  /// Returns the collisions of a body per unit of time.
  static double collision_rate(const Totals& begin, const Totals& end, int number) {
    return 2 * (end.collisions - begin.collisions) / (number * (end.time - begin.time));
  }

  Estimate collision_rate(std::size_t group) const;
  BlockRow block_row(const Block& block) const;
  Matrix3d pressure(const Totals& begin, const Totals& end, double kT, const Matrix3d& kinetic) const;
  void add_blocks(Results& results) const;
  void add_pressure(Results& results) const;
  void add_order(std::size_t group, GroupResults& results) const;
  void add_temperatures(std::size_t group, GroupResults& results) const;
  void drop_orientation(GroupResults& results) const;

  const Measured& measured_;
  const Totals& totals_;
  BlockAverages averages_;
  StructureResults structure_;
  CorrelationResults correlations_;
};

// ---- All bodies

BlockRow ResultsOf::block_row(const Block& block) const {
  const int number = measured_.options.number;
  const double time = block.end.time - block.begin.time;
  const bool oriented = !measured_.gaps.orientations;
  BlockRow row{};
  row.begin = block.begin.time;
  row.end = block.end.time;
  row.collision_rate = collision_rate(block.begin, block.end, number);
  row.translational_kT = block.all.translational_kT / block.frames;
  row.rotational_kT = block.all.rotational_kT / block.frames;
  row.S = oriented ? block.all.S / block.frames : kNothing;
  row.Z = 1 + (block.end.virial - block.begin.virial) / (3 * number * row.translational_kT * time);
  row.director = oriented ? director_of(block.all.order) : Eigen::Vector3d::Constant(kNothing);
  row.pressure = pressure(block.begin, block.end, row.translational_kT, block.kinetic / block.frames);
  return row;
}

Matrix3d ResultsOf::pressure(const Totals& begin, const Totals& end, double kT, const Matrix3d& kinetic) const {
  const Matrix3d virial = end.virial_tensor - begin.virial_tensor;
  const double share = 2 * measured_.options.number * kT * (end.time - begin.time);
  return kinetic + (virial + virial.transpose()) / share;
}

/// Adds the blocks and what only all bodies have.
void ResultsOf::add_blocks(Results& results) const {
  std::vector<double> rate, Z;
  for (const Block* block : averages_.full_blocks()) {
    const BlockRow row = block_row(*block);
    results.blocks.push_back(row);
    rate.push_back(row.collision_rate);
    Z.push_back(row.Z);
  }
  add_order(kAll, results);
  if (const auto gap = measured_.gaps.collisions) {
    results.collision_rate = results.Z = results.translational_kT = results.rotational_kT = Estimate::none({*gap});
    return;
  }
  results.translational_kT = averages_.frame_mean([](const Block& b) { return b.all.translational_kT; });
  results.rotational_kT = averages_.frame_mean([](const Block& b) { return b.all.rotational_kT; });
  if (totals_.time > 0) results.collision_rate = results.Z = Estimate::none({MissingReason::no_collisions});
  if (!(totals_.collisions > 0 && totals_.time > 0)) return;
  const int number = measured_.options.number;
  results.collision_rate = {collision_rate({}, totals_, number), mean_of_blocks(rate).error};
  if (results.blocks.empty()) return;
  results.Z = {1 + totals_.virial / (3 * number * results.translational_kT.value * totals_.time),
               mean_of_blocks(Z).error};
  add_pressure(results);
}

void ResultsOf::add_pressure(Results& results) const {
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

// ---- All bodies or one group

/// Adds S and the director of a group.
void ResultsOf::add_order(std::size_t group, GroupResults& results) const {
  if (const auto gap = measured_.gaps.orientations) {
    results.S = Estimate::none({*gap});
    return;
  }
  results.S = averages_.frame_mean([&](const Block& b) { return b.sums_of(group).S; });
  const std::vector<const Block*>& blocks = averages_.full_blocks();
  if (blocks.empty()) return;
  Matrix3d all = Matrix3d::Zero();
  for (const Block* block : blocks) all += block->sums_of(group).order;
  Director& director = results.director;
  director.axis = director_of(all);
  const auto n = static_cast<double>(blocks.size());
  if (blocks.size() < 2) return;
  double squares = 0;
  for (const Block* block : blocks)
    squares += director.axis.cross(director_of(block->sums_of(group).order)).squaredNorm();
  director.error = std::sqrt(squares / (n * (n - 1)));
}

Estimate ResultsOf::collision_rate(std::size_t group) const {
  if (totals_.collisions_of.empty() || !(totals_.time > 0)) return {};
  const auto bodies = static_cast<double>(measured_.ranges[group].size());
  std::vector<double> values;
  for (const Block* block : averages_.full_blocks()) {
    const double met = block->end.collisions_of[group] - block->begin.collisions_of[group];
    values.push_back(met / (bodies * (block->end.time - block->begin.time)));
  }
  return {totals_.collisions_of[group] / (bodies * totals_.time), mean_of_blocks(values).error};
}

/// Adds collision rate and temperatures of a group.
void ResultsOf::add_temperatures(std::size_t group, GroupResults& results) const {
  if (const auto gap = measured_.gaps.collisions) {
    results.collision_rate = results.translational_kT = results.rotational_kT = Estimate::none({*gap});
    results.axis_kT.fill(results.collision_rate);
    return;
  }
  results.collision_rate = collision_rate(group);
  results.translational_kT = averages_.frame_mean([&](const Block& b) { return b.groups[group].translational_kT; });
  results.rotational_kT = averages_.frame_mean([&](const Block& b) { return b.groups[group].rotational_kT; });
  for (int axis = 0; axis < 3; ++axis) {
    results.axis_kT[static_cast<std::size_t>(axis)] =
        averages_.frame_mean([&](const Block& b) { return b.groups[group].axis_kT[axis]; });
  }
}

/// Removes the order and relaxation of spheres, one species of several.
void ResultsOf::drop_orientation(GroupResults& results) const {
  const Estimate none = Estimate::none({MissingReason::no_orientation});
  for (Estimate* e :
       {&results.S, &results.t_C2_1overe, &results.tau_C2, &results.beta_C2, &results.D_rot, &results.D_rot_body}) {
    *e = none;
  }
  results.director = {};
  results.window_C2 = {};
}

Results ResultsOf::results() const {
  Results results;
  static_cast<Correlations&>(results) = correlations_.of_group(kAll);
  results.duration = totals_.time;
  add_blocks(results);
  const bool single = measured_.ranges.size() == 1;
  for (std::size_t g = 0; g < measured_.ranges.size(); ++g) {
    GroupResults& group = results.groups.emplace_back();
    static_cast<Correlations&>(group) = single ? static_cast<const Correlations&>(results) : correlations_.of_group(g);
    add_order(g, group);
    add_temperatures(g, group);
    group.oriented = measured_.ranges[g].oriented;
    if (!single && !group.oriented) drop_orientation(group);
    add_cubatic(averages_, single ? 0 : g + 1, measured_.ranges[g].three_axes, group);
  }
  results.crosses = structure_.crosses();
  const auto three = [](const BodyRange& r) { return r.three_axes; };
  add_cubatic(averages_, 0, std::all_of(measured_.ranges.begin(), measured_.ranges.end(), three), results);
  const bool nematic = !why_no_director(averages_, correlations_.turned());
  results.director.exists = nematic && results.director.axis.allFinite();
  for (GroupResults& group : results.groups) {
    group.director.exists = results.director.exists && (single || group.oriented);
  }
  add_phase(averages_, results);
  if (single) results.axis_kT = results.groups[0].axis_kT;
  return results;
}

}  // namespace

Results results_of(const Measured& measured, const Totals& totals, std::optional<double> fit_from) {
  return ResultsOf(measured, totals, fit_from).results();
}

std::optional<double> first_wave_number_of(const Measured& measured) {
  const BlockAverages averages(measured);
  return StructureResults(averages).first_wave_number_of_all();
}

}  // namespace ed::internal
