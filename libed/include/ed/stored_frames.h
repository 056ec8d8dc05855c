#pragma once

/// @file
/// Observables of a trajectory that has been stored, ours or another program's: what `Observables` measures while a run
/// goes on, as far as positions and orientations tell.

#include <ed/export.h>
#include <ed/observables.h>

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace ed {

/// All bodies at one time, as they were stored.
struct StoredFrame {
  double time = 0;
  std::vector<Eigen::Vector3d> position;  ///< unwrapped, continuous across the box's faces, if the options say so
  std::vector<Eigen::Matrix3d> rotation;  ///< body to world; empty: not known
  std::vector<Eigen::Vector3d> velocity;  ///< empty: not known
};

/// Settings of `analyze_frames`: what it has to know beside the frames.
struct StoredFramesOptions {
  double box = 0;  ///< edge length, of all frames
  /// Unit of distances and wave numbers: the radius of the sphere whose volume is the bodies' mean one.
  double length = 1;
  /// False where nobody knows the bodies' sizes and `length` is any: D_trans then asks for motion by the bodies' mean
  /// distance instead of that of the first peak of S(q).
  bool length_known = true;
  /// False where body i of one frame need not be body i of the next: there are no correlations in time then.
  bool same_bodies = true;
  /// False where positions are wrapped, so that displacements are not known: no MSD, alpha2, F_self, D_trans.
  bool unwrapped = true;
  std::vector<BodyGroup> groups{};  ///< their numbers add up to that of the bodies
  std::vector<int> axis{};          ///< of each body: which body axis (0, 1, 2) u is
  /// Of F_self, at most kMostWaveNumbers; empty: wave_numbers_about the first peak of S(q).
  std::vector<double> wave_numbers{};
  double longest_lag = 0;  ///< 0: a quarter of the trajectory
  /// Decays are fitted from this lag, where ballistic motion has ended: a run takes five mean collision intervals.
  /// Nothing: no fits.
  std::optional<double> fit_from{};
};

/// Results, and what they are from.
struct StoredResults : Results {
  std::vector<double> wave_numbers;
  /// Frames that correlations are from: the longest stretch of frames that are equally far apart in time, the first of
  /// several. S, g(r) and S(q) are from all frames.
  /// @{
  std::size_t first_frame = 0;
  std::size_t frames = 0;
  /// @}
};

/// Takes averages over frames, and correlations over all pairs of frames that are a lag apart, at about 20 lags a
/// decade. Errors are standard errors over blocks as long as the longest lag (2 to 16 of them). Values that frames do
/// not tell are missing for the reason MissingReason::not_told: collisions, pressure, temperatures, rotational
/// displacements, and with velocities or rotations missing what is made of them. Without unwrapped positions
/// displacements are missing for the reason not_unwrapped, without the same bodies all correlations for not_followed.
///
/// Memory: some 200 bytes a body and frame beside the frames. Throws std::invalid_argument for no frames, numbers of
/// bodies that differ, a box that is not positive, times that do not rise, a negative lag to fit from.
ED_EXPORT StoredResults analyze_frames(const std::vector<StoredFrame>& frames, const StoredFramesOptions& options);

}  // namespace ed
