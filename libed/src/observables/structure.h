#pragma once

/// Static structure: pair correlations and the structure factor of single frames.

#include "base/archive.h"
#include "observables/lag_sums.h"

#include <ed/simulation.h>

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace ed::internal {

/// Distances up to half the box, or 6 lengths; wave vectors of the box up to 12 inverse lengths. A length is the radius
/// of the sphere whose volume is the bodies' mean one: l of an ellipsoid.
struct StructureGrid {
  double box = 0;
  double length = 0;

  double reach() const;        ///< largest distance of pairs
  std::size_t bins() const;    ///< number of bins of distances, each reach() / bins() wide
  double shell_width() const;  ///< width of a shell of wave numbers: 2 pi / box, or more for large boxes
  std::size_t shells() const;  ///< number of shells of wave numbers, around 1, 2, .. shell widths
  bool known() const { return box > 0; }

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.box, self.length);
  }
};

StructureGrid structure_grid(const System& system);

/// Parts whose structure is summed apart: all bodies; with several groups each group; with 2 to kMostCrossedSpecies
/// also each two groups.
struct StructureParts {
  std::size_t groups;

  bool crossed() const { return groups > 1 && groups <= kMostCrossedSpecies; }
  std::size_t size() const { return groups < 2 ? 1 : 1 + groups + (crossed() ? groups * (groups - 1) / 2 : 0); }
  std::size_t of_group(std::size_t group) const { return groups < 2 ? 0 : 1 + group; }
  /// Returns the part of two groups, a < b, if crossed().
  std::size_t of_pair(std::size_t a, std::size_t b) const {
    return 1 + groups + a * (2 * groups - a - 1) / 2 + (b - a - 1);
  }
};

/// Sums over frames of the pairs of some bodies, and of their S(q). Of two groups: of the pairs of a body of one and a
/// body of the other.
struct StructureSums {
  std::vector<double> pairs;  ///< number of pairs in each bin
  std::vector<double> p2;     ///< sum of P2(u_i.u_j) over them
  std::vector<double> S;      ///< S(q) in each shell

  void add(const StructureSums& other);

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.pairs, self.p2, self.S);
  }
};

/// Sum of exp(i q.r) over bodies: a complex number.
struct Amplitude {
  double re = 0;
  double im = 0;
};

/// Amplitudes at the vectors of each shell.
using Amplitudes = std::vector<std::vector<Amplitude>>;

/// Returns the one of n and -n that stands for both: its first component that is not 0 is positive.
Eigen::Vector3i one_of_two(const Eigen::Vector3i& n);

/// Wave vectors of the box, some in each shell.
class WaveVectors {
 public:
  /// Takes all vectors of each shell between `from` and `to`, or `most` of them, drawn with a seed of their own; q and
  /// -q, which give the same, count as one.
  WaveVectors(const StructureGrid& grid, double from, double to, int most);

  /// Takes a shell about each of these wave numbers: all vectors whose length differs from it by at most pi / box, or
  /// `most` of them. Empty for wave numbers below pi / box.
  WaveVectors(double box, const std::vector<double>& about, int most);
  /// Takes these vectors, in units of 2 pi / box, one a shell.
  WaveVectors(double box, const std::vector<Eigen::Vector3i>& each);

  /// Returns the mean wave number of each shell; 0 for an empty one.
  const std::vector<double>& wave_numbers() const { return wave_numbers_; }

  /// Returns the number of vectors in a shell.
  std::size_t number(std::size_t shell) const { return vectors_[shell].size(); }

  /// Returns the sums of exp(i q.r) over the bodies of a range.
  Amplitudes amplitudes(const std::vector<Eigen::Vector3d>& positions, BodyRange range) const;

  /// Returns S(q) = <|sum of exp(i q.r)|^2> / n over the vectors of each shell, n the bodies of the range.
  std::vector<double> structure_factor(const std::vector<Eigen::Vector3d>& positions, BodyRange range) const;

 private:
  double box_;
  int largest_ = 0;  ///< largest of all components, in 2 pi / box
  std::vector<std::vector<Eigen::Vector3i>> vectors_;
  std::vector<double> wave_numbers_;
};

/// Returns the real part of <a conj(b)> / sqrt(n_a n_b) over the vectors of each shell, 0 for an empty one: S(q) of the
/// bodies of one group, or S_ab(q) of two by the definition of Ashcroft and Langreth (Phys. Rev. 156 (1967) 685).
std::vector<double> structure_factor(const Amplitudes& a, const Amplitudes& b, double n_a, double n_b);

/// Returns the pairs of each of the StructureParts of these ranges. P2 is summed over pairs of bodies that both have an
/// orientation (over all, if no body has one).
std::vector<StructureSums> count_pairs(const StructureGrid& grid, const Snapshot& snapshot,
                                       const std::vector<BodyRange>& ranges);

/// Sets S of each of the StructureParts of these ranges.
void add_structure_factors(const Snapshot& snapshot, const std::vector<BodyRange>& ranges, const WaveVectors& vectors,
                           std::vector<StructureSums>& sums);

/// A maximum of S(q).
struct Peak {
  double q;
  double S;
};

/// Returns the shell with the highest S(q) between 1.5 and 7 inverse lengths; S.size() without values.
std::size_t highest(const std::vector<double>& q, const std::vector<double>& S, double length);

/// Returns whether a height of S(q) is above 1 by more than five of its standard errors.
bool stands_out(double height, double error);

/// Returns the first peak: the highest value between 1.5 and 7 inverse lengths, where fluids have it, refined by the
/// parabola through it and its neighbours. NaN without values.
Peak first_peak(const std::vector<double>& q, const std::vector<double>& S, double length);

/// Returns S(q) of hard spheres of radius 1 at a packing fraction below 1, in Percus and Yevick's approximation:
/// Wertheim, Phys. Rev. Lett. 10 (1963) 321. Inaccurate for q much below 1, where its terms cancel.
double percus_yevick(double q, double packing_fraction);

/// Returns the first peak if it stands out of the scatter: higher than 1 by five standard errors, where S(q) is the
/// mean over `frames` independent frames (the error of n vectors in m frames is S / sqrt(n m)).
std::optional<double> clear_peak(const WaveVectors& vectors, const std::vector<double>& S, double frames,
                                 double length);

/// Returns the best estimate of the first peak's wave number after few frames, from S(q), the mean over `frames` frames
/// at those vectors: clear_peak if there is one. Otherwise, where the highest value is chance, Percus and Yevick's
/// S(q) of spheres with the bodies' mean volume, at their packing fraction, is stretched along q and scaled in height,
/// 1 + a (S_PY(q / s) - 1), until it fits best between 1 and 7 inverse lengths; ln s is 0 +- 0.08 if S(q) says nothing.
/// It is the top of that.
double likely_peak(const WaveVectors& vectors, const std::vector<double>& S, double frames, const StructureGrid& grid,
                   double packing_fraction);

}  // namespace ed::internal
