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

/// Sums over frames of the pairs of some bodies, and of their S(q).
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

/// Wave vectors of the box, some in each shell.
class WaveVectors {
 public:
  /// Takes all vectors of each shell between `from` and `to`, or `most` of them, drawn with a seed of their own; q and
  /// -q, which give the same, count as one.
  WaveVectors(const StructureGrid& grid, double from, double to, int most);

  /// Returns the mean wave number of each shell; 0 for an empty one.
  const std::vector<double>& wave_numbers() const { return wave_numbers_; }

  /// Returns the number of vectors in a shell.
  std::size_t number(std::size_t shell) const { return vectors_[shell].size(); }

  /// Returns S(q) = <|sum of exp(i q.r)|^2> / n over the vectors of each shell, n the bodies of the range.
  std::vector<double> structure_factor(const std::vector<Eigen::Vector3d>& positions, BodyRange range) const;

 private:
  double box_;
  int largest_ = 0;  ///< largest of all components, in 2 pi / box
  std::vector<std::vector<Eigen::Vector3i>> vectors_;
  std::vector<double> wave_numbers_;
};

/// Returns the pairs of each range, and with more than one range first those of all bodies.
std::vector<StructureSums> count_pairs(const StructureGrid& grid, const Snapshot& snapshot,
                                       const std::vector<BodyRange>& ranges);

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
