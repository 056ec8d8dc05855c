#include "base/legendre.h"
#include "base/periodic.h"
#include "cells/grid.h"
#include "observables/structure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kNoPart = static_cast<std::size_t>(-1);
constexpr int kFewBodies = 1000;  ///< number of bodies up to which all pairs are visited: quicker than cells

/// Bins behind the last one, for pairs that are too far apart: several, so that successive ones do not wait for each
/// other.
constexpr std::size_t kOverflowBins = 4;

/// Puts a pair where it belongs. Sums have kOverflowBins bins more than the grid.
class PairCounter {
 public:
  PairCounter(const StructureGrid& grid, std::size_t bodies, const std::vector<BodyRange>& ranges,
              std::vector<StructureSums>& sums)
      : sums_(sums),
        bins_(grid.bins()),
        scale_(static_cast<double>(bins_) / grid.reach()),
        most_(2 * grid.reach() * grid.reach()),
        groups_(ranges.size()),
        oriented_(std::any_of(ranges.begin(), ranges.end(), [](const BodyRange& r) { return r.oriented; })) {
    if (groups_ < 2) return;
    group_.resize(bodies);
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

  /// Whether pairs have a P2; else count() needs none.
  bool oriented() const { return oriented_; }

  /// Returns the bin of a distance; one of the overflow bins, chosen by `salt`, if it is too large.
  std::int32_t bin(double squared_distance, std::size_t salt) const {
    // Limited, so that the conversion has a value.
    const auto bin = static_cast<std::int32_t>(std::sqrt(std::min(squared_distance, most_)) * scale_);
    const auto end = static_cast<std::int32_t>(bins_);
    return bin < end ? bin : end + static_cast<std::int32_t>(salt & (kOverflowBins - 1));
  }

  /// Counts pairs of body i with bodies from j on: a bin and a P2 of each.
  void count(std::size_t i, std::size_t j, std::span<const std::int32_t> bins, const double* p2) {
    if (groups_ > 1) {
      for (std::size_t k = 0; k < bins.size(); ++k) count_of_groups(i, j + k, at(bins[k]), oriented_ ? p2[k] : 0);
      return;
    }
    double* const pairs = sums_[0].pairs.data();
    if (!oriented_) {
      for (const std::int32_t bin : bins) pairs[bin] += 1;
      return;
    }
    double* const sums = sums_[0].p2.data();
    for (std::size_t k = 0; k < bins.size(); ++k) {
      pairs[bins[k]] += 1;
      sums[bins[k]] += p2[k];
    }
  }

 private:
  /// Share of pairs of two groups in the sums.
  struct PairKind {
    std::size_t part = kNoPart;  ///< part besides that of all bodies
    double oriented = 1;         ///< 0 if some of the bodies have no orientation
  };

  static std::size_t at(std::int32_t bin) { return static_cast<std::size_t>(bin); }

  void count_of_groups(std::size_t i, std::size_t j, std::size_t bin, double value) {
    const PairKind& kind = kinds_[group_[i] * groups_ + group_[j]];
    add(sums_[0], bin, kind.oriented * value);
    if (kind.part != kNoPart) add(sums_[kind.part], bin, kind.oriented * value);
  }

  static void add(StructureSums& sums, std::size_t bin, double value) {
    sums.pairs[bin] += 1;
    sums.p2[bin] += value;
  }

  std::vector<StructureSums>& sums_;
  std::size_t bins_;
  double scale_;
  double most_;  ///< square of a distance that is too large
  std::size_t groups_;
  bool oriented_;                   ///< true if bodies of some group are
  std::vector<std::size_t> group_;  ///< group of each body, if there are several
  std::vector<PairKind> kinds_;     ///< kinds of pairs, of each two groups: [a * groups + b]
};

/// Coordinates of vectors, those of one axis together.
struct Coordinates {
  std::vector<double> x, y, z;

  explicit Coordinates(std::size_t number) : x(number), y(number), z(number) {}

  void set(std::size_t i, const Vector3d& v) {
    x[i] = v.x();
    y[i] = v.y();
    z[i] = v.z();
  }
};

/// Visits all pairs: bins and P2 of a body with all later ones, loops that compilers vectorise, and no branch on which
/// of them are near.
void count_all(const StructureGrid& grid, const Snapshot& snapshot, PairCounter& counter) {
  const std::size_t n = snapshot.position.size();
  Coordinates r(n), u(counter.oriented() ? n : 0);
  for (std::size_t i = 0; i < n; ++i) {
    r.set(i, nearest_image(snapshot.position[i], grid.box));
    if (counter.oriented()) u.set(i, snapshot.axis[i]);
  }
  const double half = 0.5 * grid.box;
  const double box = grid.box;
  const auto image = [=](double d) {
    const double size = std::abs(d);
    return size - (size > half ? box : 0.0);
  };
  std::vector<std::int32_t> bins(n);
  std::vector<double> values(u.x.size());
  for (std::size_t i = 0; i + 1 < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const double dx = image(r.x[j] - r.x[i]), dy = image(r.y[j] - r.y[i]), dz = image(r.z[j] - r.z[i]);
      bins[j] = counter.bin(dx * dx + dy * dy + dz * dz, j);
    }
    for (std::size_t j = i + 1; j < u.x.size(); ++j) {
      values[j] = p2(u.x[i] * u.x[j] + (u.y[i] * u.y[j] + u.z[i] * u.z[j]));
    }
    counter.count(i, i + 1, std::span(bins).subspan(i + 1), values.empty() ? nullptr : &values[i + 1]);
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
      if (other.body <= i) continue;
      const auto later = static_cast<std::size_t>(other.body);
      const std::int32_t bin = counter.bin(other.r.squaredNorm(), later);
      const double value = p2(snapshot.axis[at].dot(snapshot.axis[later]));
      counter.count(at, later, {&bin, 1}, &value);
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
    part.pairs.assign(grid.bins() + kOverflowBins, 0);
    part.p2.assign(grid.bins() + kOverflowBins, 0);
  }
  PairCounter counter(grid, snapshot.position.size(), ranges, sums);
  if (snapshot.position.size() <= kFewBodies) {
    count_all(grid, snapshot, counter);
  } else {
    count_in_cells(grid, snapshot, counter);
  }
  for (StructureSums& part : sums) {
    part.pairs.resize(grid.bins());
    part.p2.resize(grid.bins());
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
