#include "observables/measured.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace ed::internal {
namespace {

// Times are in the options' time unit.
constexpr double kLongestLag = 40;     ///< default cap: MSD slopes have settled well before, errors grow beyond
constexpr double kShortestLag = 1e-3;  ///< shortest lag at kLagsPerDecade, in units of the longest one
constexpr double kLagsPerDecade = 20;
/// Half as many follow below, down to here: shorter than the interval between two collisions of any fluid.
constexpr double kShortest = 2e-3;
constexpr double kShortLagsPerDecade = 10;
constexpr int kOriginsPerLongestLag = 16;
/// Structure is measured this often, but once at least from the origins of a block: it costs as much as ten other
/// frames and changes as slowly as bodies move by their size.
constexpr double kStructureTime = 1;
constexpr int kVectorsPerShell = 24;

std::vector<double> log_lags(double longest, double shortest) {
  std::vector<double> lags;
  const int number = static_cast<int>(std::ceil(-std::log10(kShortestLag) * kLagsPerDecade));
  for (int k = -number; k <= 0; ++k) lags.push_back(longest * std::pow(10.0, k / kLagsPerDecade));
  const double first = lags.front();
  for (int k = 1; first * std::pow(10.0, -k / kShortLagsPerDecade) >= shortest; ++k) {
    lags.insert(lags.begin(), first * std::pow(10.0, -k / kShortLagsPerDecade));
  }
  return lags;
}

void check(const ObservablesOptions& options) {
  const auto is_time = [](double t) { return t > 0 && std::isfinite(t); };
  if (!is_time(options.duration) || !is_time(options.time_unit) || options.number < 1) {
    throw std::invalid_argument(
        "Observables: duration, time_unit and number; accepted: positive finite times, at least 1 body");
  }
  const auto usable = [](double q) { return q > 0 && std::isfinite(q); };
  const bool all = std::all_of(options.wave_numbers.begin(), options.wave_numbers.end(), usable);
  if (all && options.wave_numbers.size() <= kMostWaveNumbers) return;
  throw std::invalid_argument("Observables: wave_numbers; accepted: up to " + std::to_string(kMostWaveNumbers) +
                              " positive finite numbers");
}

}  // namespace

Totals totals_of(const Simulation& simulation, const std::vector<BodyRange>& groups) {
  Totals totals{simulation.time(),
                static_cast<double>(simulation.counters().collisions),
                simulation.virial(),
                simulation.virial_tensor(),
                {}};
  for (const BodyRange& group : groups) {
    const auto collisions = simulation.collisions_of(static_cast<int>(group.begin), static_cast<int>(group.end));
    totals.collisions_of.push_back(static_cast<double>(collisions));
  }
  return totals;
}

void Block::append(const Block& next) {
  for (std::size_t n = 0; n < lags.size(); ++n) lags[n].add(next.lags[n], 1);
  for (std::size_t g = 0; g < groups.size(); ++g) groups[g] += next.groups[g];
  all += next.all;
  kinetic += next.kinetic;
  end = next.end;
  frames += next.frames;
  origins += next.origins;
  for (std::size_t p = 0; p < structure.size(); ++p) structure[p].add(next.structure[p]);
  structure_frames += next.structure_frames;
}

Measured::Measured(const ObservablesOptions& wanted) : options(wanted) {
  check(options);
  make_groups();
  double longest = options.longest_lag;
  if (!(longest > 0)) longest = std::min(kLongestLag * options.time_unit, options.duration / 16);
  lags = log_lags(longest, kShortest * options.time_unit);
  origins_per_block = std::clamp(160000 / std::max(1, options.number), 1, kOriginsPerLongestLag);
  spacing = longest / origins_per_block;
  structure_every = static_cast<int>(
      std::clamp(std::ceil(kStructureTime * options.time_unit / spacing), 1.0, 1.0 * origins_per_block));
}

void Measured::make_groups() {
  if (options.groups.empty()) options.groups.push_back({options.number, 2});
  int first = 0;
  for (const BodyGroup& group : options.groups) {
    const bool axes = group.rotation_axes == 2 || group.rotation_axes == 3;
    if (group.number < 1 || group.number > options.number - first || !axes) {
      throw std::invalid_argument(
          "Observables: groups; accepted: numbers above 0 that add up to the number of bodies, 2 or 3 rotation axes");
    }
    const auto begin = static_cast<std::size_t>(first);
    ranges.push_back({begin, begin + static_cast<std::size_t>(group.number), group.rotation_axes == 3});
    weights.push_back(static_cast<double>(group.number) / options.number);
    first += group.number;
  }
  if (first == options.number) return;
  throw std::invalid_argument("Observables: groups; accepted: numbers that add up to the number of bodies");
}

bool Measured::add_origin(const Simulation& simulation, const Snapshot& now) {
  const std::size_t before = blocks.size();
  Block& block = open_block(simulation);
  if (block.origins % structure_every == 0) {
    if (!grid.known()) grid = structure_grid(simulation.system());
    add_structure(now, block);
  }
  block.origins += 1;
  add_order(now, block);
  add_temperatures(simulation, block);
  block.end = totals_of(simulation, ranges);
  return blocks.size() < before;
}

/// The block that takes the next origin.
Block& Measured::open_block(const Simulation& simulation) {
  const auto full = [this] { return blocks.empty() || blocks.back().origins == origins_per_block; };
  if (!full()) return blocks.back();
  const Totals totals = totals_of(simulation, ranges);
  if (!blocks.empty()) blocks.back().end = totals;
  if (blocks.size() == kMaxBlocks) merge_blocks();
  if (!full()) return blocks.back();
  Block& block = blocks.emplace_back();
  block.lags.resize(lags.size() * ranges.size());
  block.groups.resize(ranges.size());
  block.structure.resize(structure_parts());
  block.begin = totals;
  return block;
}

void Measured::add_structure(const Snapshot& now, Block& block) {
  if (!wave_vectors_) wave_vectors_ = wave_vectors_of(grid);
  const std::vector<StructureSums> pairs = count_pairs(grid, now, ranges);
  for (std::size_t p = 0; p < block.structure.size(); ++p) {
    StructureSums sums = pairs[p];
    const BodyRange all{0, now.position.size(), false};
    sums.S = wave_vectors_->structure_factor(now.position, p == 0 ? all : ranges[p - 1]);
    if (block.structure[p].pairs.empty()) {
      block.structure[p] = std::move(sums);
    } else {
      block.structure[p].add(sums);
    }
  }
  block.structure_frames += 1;
}

void Measured::add_order(const Snapshot& now, Block& block) const {
  const FrameSums all = order_and_speeds(now, {0, now.axis.size(), false});
  block.frames += 1;
  block.all += all;
  for (std::size_t g = 0; g < ranges.size(); ++g) {
    block.groups[g] += ranges.size() == 1 ? all : order_and_speeds(now, ranges[g]);
  }
}

void Measured::add_temperatures(const Simulation& simulation, Block& block) {
  const System system = simulation.system();
  const KineticState kinetic = kinetic_state(system);
  block.all.translational_kT += kinetic.translational_kT;
  block.all.rotational_kT += kinetic.rotational_kT;
  block.kinetic += kinetic_tensor(system);
  for (std::size_t g = freedoms.size(); g < ranges.size(); ++g) freedoms.push_back(freedoms_of(system, ranges[g]));
  for (std::size_t g = 0; g < ranges.size(); ++g) {
    block.groups[g] +=
        temperatures(ranges.size() == 1 ? kinetic : kinetic_state(part_of(system, ranges[g])), freedoms[g]);
  }
}

void Measured::merge_blocks() {
  for (std::size_t k = 0; k + 1 < blocks.size(); k += 2) {
    blocks[k].append(blocks[k + 1]);
    if (k > 0) blocks[k / 2] = std::move(blocks[k]);
  }
  blocks.resize(blocks.size() / 2);
  origins_per_block *= 2;
}

bool Measured::structure_fits(const Block& block) const {
  if (block.structure.size() != structure_parts()) return false;
  // Every block begins with a frame whose structure is measured.
  return std::all_of(block.structure.begin(), block.structure.end(), [this](const StructureSums& sums) {
    return sums.pairs.size() == grid.bins() && sums.p2.size() == grid.bins() && sums.S.size() == grid.shells();
  });
}

WaveVectors wave_vectors_of(const StructureGrid& grid) {
  return {grid, 0, std::numeric_limits<double>::infinity(), kVectorsPerShell};
}

bool Measured::fits(std::size_t number_of_lags) const {
  const auto block_fits = [this](const Block& b) {
    const std::size_t n = ranges.size();
    return b.lags.size() == lags.size() * n && b.groups.size() == n && b.begin.collisions_of.size() == n &&
           b.end.collisions_of.size() == n && structure_fits(b);
  };
  // Cells of pairs and shells are as many as the bodies' sizes make them: a few hundred.
  const bool grid_fits = blocks.empty() || (grid.box > 0 && grid.length > 0 && grid.box < 1e6 * grid.length);
  return grid_fits && lags.size() == number_of_lags && (freedoms.empty() || freedoms.size() == ranges.size()) &&
         origins_per_block > 0 && blocks.size() <= kMaxBlocks && std::all_of(blocks.begin(), blocks.end(), block_fits);
}

}  // namespace ed::internal
