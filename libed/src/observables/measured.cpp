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
constexpr double kDefaultLags = 16;    ///< default longest lags in the duration
constexpr double kShortestLag = 1e-3;  ///< shortest lag at kLagsPerDecade, in units of the longest one
constexpr double kLagsPerDecade = 20;
/// Half as many follow below, down to here: shorter than the interval between two collisions of any fluid.
constexpr double kShortest = 2e-3;
constexpr double kShortLagsPerDecade = 10;
/// Origins are a time unit apart, within these numbers: closer ones tell little that is new, and frames cost time.
constexpr int kFewestOriginsPerLongestLag = 4;
constexpr int kOriginsPerLongestLag = 16;
/// Most bodies of all frames at origins in a longest lag.
constexpr int kBodiesPerLongestLag = 160000;
/// Structure is measured this often, but once at least from the origins of a block: it costs much more than other
/// frames and changes as slowly as bodies move by their size.
constexpr double kStructureTime = 1;
constexpr int kVectorsPerShell = 24;
/// The van Hove function is counted at a few lags, the longest one and shorter ones.
constexpr double kHoveLagsPerDecade = 4;
constexpr std::size_t kMostHoveLags = 12;

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
  if (!(options.longest_lag >= 0 && options.longest_lag <= options.duration)) {
    throw std::invalid_argument("Observables: longest_lag; accepted: 0 for the default, or a time up to the duration");
  }
  if (options.bonds.neighbours < kFewestNeighbours || options.bonds.neighbours > kMostNeighbours) {
    throw std::invalid_argument("Observables: bonds.neighbours; accepted: " + std::to_string(kFewestNeighbours) +
                                " to " + std::to_string(kMostNeighbours));
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
  for (std::size_t n = 0; n < overlap2.size(); ++n) overlap2[n] += next.overlap2[n];
  for (std::size_t n = 0; n < displaced.size(); ++n) displaced[n] += next.displaced[n];
  for (std::size_t n = 0; n < collective.size(); ++n) collective[n] += next.collective[n];
  for (std::size_t g = 0; g < groups.size(); ++g) groups[g] += next.groups[g];
  all += next.all;
  kinetic += next.kinetic;
  end = next.end;
  frames += next.frames;
  origins += next.origins;
  for (std::size_t p = 0; p < structure.size(); ++p) structure[p].add(next.structure[p]);
  structure_frames += next.structure_frames;
  phase.add(next.phase);
}

Measured::Measured(const ObservablesOptions& wanted) : options(wanted) {
  check(options);
  make_groups();
  double longest = options.longest_lag;
  if (!(longest > 0)) longest = options.duration / kDefaultLags;
  lags = log_lags(longest, kShortest * options.time_unit);
  choose_hove_lags();
  const int most = std::clamp(kBodiesPerLongestLag / options.number, 1, kOriginsPerLongestLag);
  const double apart = std::min(longest / options.time_unit, 1.0 * kOriginsPerLongestLag);
  origins_per_block = std::clamp(static_cast<int>(apart), std::min(kFewestOriginsPerLongestLag, most), most);
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
    ranges.push_back({begin, begin + static_cast<std::size_t>(group.number), group.rotation_axes == 3, group.oriented});
    weights.push_back(static_cast<double>(group.number) / options.number);
    first += group.number;
  }
  double oriented = 0;
  for (const BodyGroup& group : options.groups) oriented += group.oriented ? group.number : 0;
  if (!any_oriented()) gaps.without_orientations();
  weights_of_rotations = weights;
  for (std::size_t g = 0; g < ranges.size() && oriented > 0 && oriented < options.number; ++g) {
    weights_of_rotations[g] = ranges[g].oriented ? ranges[g].size() / oriented : 0;
  }
  if (first == options.number) return;
  throw std::invalid_argument("Observables: groups; accepted: numbers that add up to the number of bodies");
}

bool Measured::add_origin(const Simulation& simulation, const Snapshot& now) {
  const std::size_t before = blocks.size();
  Block& block = open_block(simulation);
  if (block.origins % structure_every == 0) {
    if (!grid.known()) {
      const System system = simulation.system();
      grid = structure_grid(system);
      if (options.bonds.hexatic) axial_length = internal::axial_length(system, ranges);
    }
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
  make_room(block);
  block.begin = totals;
  return block;
}

void Measured::add_lag(const Snapshot& origin, const Eigen::Vector3d& director, const Snapshot& now, std::size_t lag,
                       Block& block) const {
  double overlap = 0;
  for (std::size_t g = 0; g < ranges.size(); ++g) {
    const LagSums sums = correlate(origin, now, ranges[g], options.wave_numbers, overlap_length(), director);
    block.lags[lag * ranges.size() + g].add(sums, 1);
    overlap += weights[g] * sums.overlap;
  }
  block.overlap2[lag] += overlap * overlap;
  count_displacements(origin, now, lag, block);
}

/// Counts displacements by their length, at the lags that the van Hove function is wanted at.
void Measured::count_displacements(const Snapshot& origin, const Snapshot& now, std::size_t lag, Block& block) const {
  const auto found = std::lower_bound(hove_lags.begin(), hove_lags.end(), lag);
  if (found == hove_lags.end() || *found != lag) return;
  const auto h = static_cast<std::size_t>(found - hove_lags.begin());
  const double per_bin = 1 / (kHoveWidth * grid.length);
  for (std::size_t g = 0; g < ranges.size(); ++g) {
    double* bins = &block.displaced[(h * ranges.size() + g) * kHoveBins];
    for (std::size_t i = ranges[g].begin; i < ranges[g].end; ++i) {
      const double bin = (now.position[i] - origin.position[i]).norm() * per_bin;
      if (bin < kHoveBins) bins[static_cast<std::size_t>(bin)] += 1;
    }
  }
}

Amplitudes Measured::amplitudes_of(const Snapshot& frame) {
  if (!options.collective) return {};
  if (!density_vectors_) density_vectors_.emplace(grid.box, options.wave_numbers, kCollectiveVectors);
  return density_vectors_->amplitudes(frame.position, {0, frame.position.size(), false});
}

void Measured::add_collective_lag(const Amplitudes& origin, const Amplitudes& now, std::size_t lag,
                                  Block& block) const {
  if (!options.collective || options.wave_numbers.empty()) return;
  if (block.collective.empty()) block.collective.resize(collective_size());
  add_collective(origin, now, options.number, &block.collective[kCollectiveSums * lag * options.wave_numbers.size()]);
}

void Measured::choose_hove_lags() {
  hove_lags.clear();
  double most = std::numeric_limits<double>::infinity();
  for (std::size_t k = lags.size(); k-- > 0 && hove_lags.size() < kMostHoveLags;) {
    if (lags[k] > most) continue;
    hove_lags.insert(hove_lags.begin(), k);
    most = lags[k] * std::pow(10.0, -1 / kHoveLagsPerDecade) * (1 + 1e-9);
  }
}

void Measured::make_room(Block& block) const {
  block.lags.resize(lags.size() * ranges.size());
  block.overlap2.resize(lags.size());
  block.displaced.resize(hove_lags.size() * ranges.size() * kHoveBins);
  block.collective.resize(options.collective ? collective_size() : 0);
  block.groups.resize(ranges.size());
  block.structure.resize(parts().size());
}

void Measured::add_structure(const Snapshot& now, Block& block) {
  if (!wave_vectors_) wave_vectors_ = wave_vectors_of(grid);
  std::vector<StructureSums> parts_now = count_pairs(grid, now, ranges);
  add_structure_factors(now, ranges, *wave_vectors_, parts_now);
  for (std::size_t p = 0; p < block.structure.size(); ++p) {
    StructureSums& sums = parts_now[p];
    if (block.structure[p].pairs.empty()) {
      block.structure[p] = std::move(sums);
    } else {
      block.structure[p].add(sums);
    }
  }
  block.structure_frames += 1;
  if (followed.empty()) followed = followed_vectors(grid, now, director(now));
  block.phase.add(phase(now));
}

PhaseSums Measured::phase(const Snapshot& now) const {
  PhaseSums sums = phase_of(grid, now, phase_parts(), followed, options.bonds);
  if (options.bonds.hexatic && axial_length > 0) {
    sums.hexatic =
        hexatic_order(oriented_positions(now.position, ranges), grid.box, director(now), kLayerReach * axial_length);
  }
  return sums;
}

/// The bodies of each part of the structure. Those of all are taken to have three axes if each group's have.
std::vector<BodyRange> Measured::phase_parts() const {
  if (ranges.size() == 1) return ranges;
  std::vector<BodyRange> parts = ranges;
  const bool three = std::all_of(ranges.begin(), ranges.end(), [](const BodyRange& r) { return r.three_axes; });
  parts.insert(parts.begin(), BodyRange{0, ranges.back().end, three});
  return parts;
}

Eigen::Vector3d Measured::director(const Snapshot& now) const {
  if (!partly_oriented()) return director_of(now);
  std::vector<BodyRange> oriented = ranges;
  std::erase_if(oriented, [](const BodyRange& range) { return !range.oriented; });
  return director_of(order_tensor(now.axis, oriented));
}

void Measured::add_order(const Snapshot& now, Block& block) const {
  FrameSums all = order_and_speeds(now, {0, now.axis.size(), false});
  block.frames += 1;
  const bool partly = partly_oriented();
  if (partly) {
    all.order.setZero();
    all.w2 = 0;
  }
  for (std::size_t g = 0; g < ranges.size(); ++g) {
    const FrameSums own = ranges.size() == 1 ? all : order_and_speeds(now, ranges[g]);
    block.groups[g] += own;
    if (!partly) continue;
    all.order += weights_of_rotations[g] * own.order;
    all.w2 += weights_of_rotations[g] * own.w2;
  }
  if (partly) all.S = largest_eigenvalue(all.order);
  block.all += all;
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
  if (block.structure.size() != parts().size()) return false;
  if (block.phase.cubatic.size() != phase_parts().size() || block.phase.intensities.size() != followed.size()) {
    return false;
  }
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
    return b.lags.size() == lags.size() * n && b.overlap2.size() == lags.size() &&
           b.displaced.size() == hove_lags.size() * n * kHoveBins && b.groups.size() == n &&
           b.collective.size() == (options.collective ? collective_size() : 0) && b.begin.collisions_of.size() == n &&
           b.end.collisions_of.size() == n && structure_fits(b);
  };
  // Cells of pairs and shells are as many as the bodies' sizes make them: a few hundred.
  const bool grid_fits = blocks.empty() || (grid.box > 0 && grid.length > 0 && grid.box < 1e6 * grid.length);
  return grid_fits && axial_length >= 0 && std::isfinite(axial_length) && lags.size() == number_of_lags &&
         (freedoms.empty() || freedoms.size() == ranges.size()) && origins_per_block > 0 &&
         blocks.size() <= kMaxBlocks && std::all_of(blocks.begin(), blocks.end(), block_fits);
}

}  // namespace ed::internal
