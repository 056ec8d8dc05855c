#pragma once

/// Correlations of two frames of a run, compared body by body.

#include "base/archive.h"
#include "observables/order/directed.h"

#include <ed/archive_simulation.h>
#include <ed/observables.h>
#include <ed/snapshot.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace ed::internal {

/// Bodies begin, begin + 1, .., end - 1.
struct BodyRange {
  std::size_t begin;
  std::size_t end;
  bool three_axes;       ///< true if each body axis is correlated by itself
  bool oriented = true;  ///< false for spheres

  double size() const { return static_cast<double>(end - begin); }
};

/// Sums, over the origins of a block, of the quantities measured at one lag: averages over the bodies of a range.
struct LagSums {
  double count = 0;
  double overlap = 0;   ///< Q, the share of bodies that have moved by less than the overlap length
  double overlap2 = 0;  ///< Q^2; of several groups together Block::overlap2 has it
  double msd = 0;
  double r4 = 0;  ///< <|r(t) - r(0)|^4>
  double rot_msd = 0;
  double rot_msd_body = 0;
  double c1 = 0;
  double c2 = 0;
  double vacf = 0;                                         ///< <v(t).v(0)>
  double wacf = 0;                                         ///< <w(t).w(0)>, spin excluded
  Eigen::Vector3d rot_msd_axis = Eigen::Vector3d::Zero();  ///< the body axes' shares of rot_msd_body
  Eigen::Vector3d c1_axis = Eigen::Vector3d::Zero();       ///< c1 of each body axis
  Eigen::Vector3d c2_axis = Eigen::Vector3d::Zero();       ///< c2 of each body axis
  std::array<double, kMostWaveNumbers> f_self{};  ///< F_self at the wave numbers of the options, in their order
  /// F / S at these, times count; of all bodies only, from Block::collective: neither added nor saved.
  std::array<double, kMostWaveNumbers> f_collective{};
  DirectedSums directed;  ///< displacements by direction

  /// Adds sums with a weight: the range's share of the bodies that are averaged.
  void add(const LagSums& other, double weight) { add(other, weight, weight); }
  /// Overload with a weight of its own for what depends on orientations or rotations.
  void add(const LagSums& other, double weight, double weight_of_rotations);
};

template <class Archive, Is<LagSums> T>
void fields(Archive& archive, T& s) {
  archive(s.count, s.overlap, s.overlap2, s.msd, s.r4, s.rot_msd, s.rot_msd_body, s.c1, s.c2, s.vacf, s.wacf,
          s.rot_msd_axis, s.c1_axis, s.c2_axis, s.f_self, s.directed);
}

/// Returns averages over the bodies of a range: what depends on orientations or rotations if it is oriented, with
/// c1_axis and c2_axis if it has three axes (rotations are read only then). Bodies overlap with where they were if they
/// have moved by less than `overlap_length`. `director` is that of the earlier frame.
///
/// F_self is averaged over all directions of q: sin(q r) / (q r), r the displacement, which a box does not confine.
LagSums correlate(const Snapshot& a, const Snapshot& b, BodyRange range, std::span<const double> wave_numbers,
                  double overlap_length, const Eigen::Vector3d& director);

/// Return single quantities of correlate().
/// @{
double mean_square_displacement(const Snapshot& a, const Snapshot& b, BodyRange range);
double mean_p2(const Snapshot& a, const Snapshot& b, BodyRange range);
double self_scattering(const Snapshot& a, const Snapshot& b, BodyRange range, double wave_number);
/// @}

}  // namespace ed::internal
