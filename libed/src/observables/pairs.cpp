#include "base/legendre.h"
#include "base/periodic.h"
#include "cells/grid.h"
#include "observables/structure.h"

#include <algorithm>
#include <cmath>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kNoPart = static_cast<std::size_t>(-1);
constexpr int kFewBodies = 1000;  ///< number of bodies up to which all pairs are visited: quicker than cells

/// Puts a pair where it belongs.
class PairCounter {
 public:
  PairCounter(const StructureGrid& grid, const Snapshot& snapshot, const std::vector<BodyRange>& ranges,
              std::vector<StructureSums>& sums)
      : snapshot_(snapshot),
        sums_(sums),
        bins_(grid.bins()),
        scale_(static_cast<double>(bins_) / grid.reach()),
        groups_(ranges.size()) {
    if (groups_ < 2) return;
    group_.resize(snapshot.position.size());
    for (std::size_t g = 0; g < groups_; ++g) {
      std::fill(group_.begin() + static_cast<std::ptrdiff_t>(ranges[g].begin),
                group_.begin() + static_cast<std::ptrdiff_t>(ranges[g].end), g);
    }
    const StructureParts parts{groups_};
    kinds_.resize(groups_ * groups_);
    for (std::size_t a = 0; a < groups_; ++a) {
      for (std::size_t b = 0; b < groups_; ++b) {
        PairKind& kind = kinds_[a * groups_ + b];
        kind.oriented = ranges[a].oriented && ranges[b].oriented ? 1 : 0;
        if (a == b) kind.part = parts.of_group(a);
        if (a != b && parts.crossed()) kind.part = parts.of_pair(std::min(a, b), std::max(a, b));
      }
    }
  }

  void count(std::size_t i, std::size_t j, double squared_distance) {
    const auto bin = static_cast<std::size_t>(std::sqrt(squared_distance) * scale_);
    if (bin >= bins_) return;
    const double value = p2(snapshot_.axis[i].dot(snapshot_.axis[j]));
    if (groups_ < 2) {
      add(sums_[0], bin, value);
      return;
    }
    const PairKind& kind = kinds_[group_[i] * groups_ + group_[j]];
    add(sums_[0], bin, kind.oriented * value);
    if (kind.part != kNoPart) add(sums_[kind.part], bin, kind.oriented * value);
  }

 private:
  /// Share of pairs of two groups in the sums.
  struct PairKind {
    std::size_t part = kNoPart;  ///< part besides that of all bodies
    double oriented = 1;         ///< 0 if some of the bodies have no orientation
  };

  static void add(StructureSums& sums, std::size_t bin, double value) {
    sums.pairs[bin] += 1;
    sums.p2[bin] += value;
  }

  const Snapshot& snapshot_;
  std::vector<StructureSums>& sums_;
  std::size_t bins_;
  double scale_;
  std::size_t groups_;
  std::vector<std::size_t> group_;  ///< group of each body, if there are several
  std::vector<PairKind> kinds_;     ///< kinds of pairs, of each two groups: [a * groups + b]
};

/// Visits all pairs: first the distances of a body from all later ones, a loop that compilers vectorise.
void count_all(const StructureGrid& grid, const Snapshot& snapshot, PairCounter& counter) {
  const double reach2 = grid.reach() * grid.reach();
  const std::size_t n = snapshot.position.size();
  std::vector<double> x(n), y(n), z(n), squared(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3d r = nearest_image(snapshot.position[i], grid.box);
    x[i] = r.x();
    y[i] = r.y();
    z[i] = r.z();
  }
  const double half = 0.5 * grid.box;
  const double box = grid.box;
  const auto image = [=](double d) {
    const double size = std::abs(d);
    return size - (size > half ? box : 0.0);
  };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const double dx = image(x[j] - x[i]), dy = image(y[j] - y[i]), dz = image(z[j] - z[i]);
      squared[j] = dx * dx + dy * dy + dz * dz;
    }
    for (std::size_t j = i + 1; j < n; ++j) {
      if (squared[j] < reach2) counter.count(i, j, squared[j]);
    }
  }
}

void count_in_cells(const StructureGrid& grid, const Snapshot& snapshot, PairCounter& counter) {
  const auto number = static_cast<int>(snapshot.position.size());
  CellGrid cells(number, grid.box, grid.reach());
  for (int i = 0; i < number; ++i) cells.place(i, snapshot.position[static_cast<std::size_t>(i)]);
  std::vector<NearBody> buffer;
  for (int i = 0; i < number; ++i) {
    const auto at = static_cast<std::size_t>(i);
    for (const NearBody& other : cells.collect(snapshot.position[at], grid.reach(), buffer)) {
      if (other.body > i) counter.count(at, static_cast<std::size_t>(other.body), other.r.squaredNorm());
    }
  }
}

void add(const Amplitudes& some, Amplitudes& sum) {
  for (std::size_t shell = 0; shell < sum.size(); ++shell) {
    for (std::size_t v = 0; v < sum[shell].size(); ++v) {
      sum[shell][v].re += some[shell][v].re;
      sum[shell][v].im += some[shell][v].im;
    }
  }
}

}  // namespace

std::vector<StructureSums> count_pairs(const StructureGrid& grid, const Snapshot& snapshot,
                                       const std::vector<BodyRange>& ranges) {
  std::vector<StructureSums> sums(StructureParts{ranges.size()}.size());
  for (StructureSums& part : sums) {
    part.pairs.assign(grid.bins(), 0);
    part.p2.assign(grid.bins(), 0);
  }
  PairCounter counter(grid, snapshot, ranges, sums);
  if (snapshot.position.size() <= kFewBodies) {
    count_all(grid, snapshot, counter);
  } else {
    count_in_cells(grid, snapshot, counter);
  }
  return sums;
}

void add_structure_factors(const Snapshot& snapshot, const std::vector<BodyRange>& ranges, const WaveVectors& vectors,
                           std::vector<StructureSums>& sums) {
  const StructureParts parts{ranges.size()};
  if (ranges.size() < 2) {
    sums[0].S = vectors.structure_factor(snapshot.position, {0, snapshot.position.size(), false});
    return;
  }
  std::vector<Amplitudes> of;
  of.reserve(ranges.size());
  for (const BodyRange& range : ranges) of.push_back(vectors.amplitudes(snapshot.position, range));
  Amplitudes all = of[0];
  for (std::size_t g = 0; g < ranges.size(); ++g) {
    sums[parts.of_group(g)].S = structure_factor(of[g], of[g], ranges[g].size(), ranges[g].size());
    for (std::size_t b = g + 1; b < ranges.size() && parts.crossed(); ++b) {
      sums[parts.of_pair(g, b)].S = structure_factor(of[g], of[b], ranges[g].size(), ranges[b].size());
    }
    if (g > 0) add(of[g], all);
  }
  const auto number = static_cast<double>(snapshot.position.size());
  sums[0].S = structure_factor(all, all, number, number);
}

}  // namespace ed::internal
