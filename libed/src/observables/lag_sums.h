#pragma once

/// Correlations of two frames of a run, compared body by body.

#include "base/archive.h"

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
  bool three_axes;  ///< each body axis is correlated by itself

  double size() const { return static_cast<double>(end - begin); }
};

/// Sums, over the origins of a block, of the quantities measured at one lag: averages over the bodies of a range.
struct LagSums {
  double count = 0;
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

  /// Adds sums with a weight: the range's share of the bodies that are averaged.
  void add(const LagSums& other, double weight);
};

template <class Archive, Is<LagSums> T>
void fields(Archive& archive, T& s) {
  archive(s.count, s.msd, s.r4, s.rot_msd, s.rot_msd_body, s.c1, s.c2, s.vacf, s.wacf, s.rot_msd_axis, s.c1_axis,
          s.c2_axis, s.f_self);
}

/// Returns averages over the bodies of a range, with c1_axis and c2_axis if it has three axes: rotations are read only
/// then.
///
/// F_self is averaged over all directions of q: sin(q r) / (q r), r the displacement, which a box does not confine.
LagSums correlate(const Snapshot& a, const Snapshot& b, BodyRange range, std::span<const double> wave_numbers);

/// Return single quantities of correlate().
/// @{
double mean_square_displacement(const Snapshot& a, const Snapshot& b, BodyRange range);
double mean_p2(const Snapshot& a, const Snapshot& b, BodyRange range);
double self_scattering(const Snapshot& a, const Snapshot& b, BodyRange range, double wave_number);
/// @}

}  // namespace ed::internal
