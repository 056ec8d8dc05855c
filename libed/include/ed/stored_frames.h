#pragma once

/// @file
/// Observables of a stored trajectory, from this or another program: the quantities that `Observables` measures during
/// a run, as far as they follow from positions and orientations.

#include <ed/export.h>
#include <ed/observables.h>

#include <Eigen/Core>

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace ed {

/// State of all bodies at one time, as stored.
struct StoredFrame {
  double time = 0;
  std::vector<Eigen::Vector3d> position;  ///< unwrapped, continuous across the box's faces, if the options say so
  std::vector<Eigen::Matrix3d> rotation;  ///< rotations, body to world; empty: not known
  std::vector<Eigen::Vector3d> velocity;  ///< velocities; empty: not known
};

/// Settings of `analyze_frames` that the frames do not contain.
struct StoredFramesOptions {
  double box = 0;  ///< edge length of the box, in all frames
  /// Unit of distances and wave numbers: the radius of the sphere whose volume is the bodies' mean one. Where that is
  /// unknown, a length of this order: the first peak of S(q) is looked for from 1.5 to 7 / length.
  double length = 1;
  /// False if the bodies' sizes are unknown and `length` is arbitrary. D_trans then requires motion by the bodies' mean
  /// distance instead of by the length of the first peak of S(q).
  bool length_known = true;
  /// False if body i of one frame need not be body i of the next: there are no correlations in time then.
  bool same_bodies = true;
  /// False if positions are wrapped, so that displacements are not known, nor what follows from them.
  bool unwrapped = true;
  std::vector<BodyGroup> groups{};  ///< groups of bodies, whose numbers add up to that of the bodies
  std::vector<int> axis{};          ///< index (0, 1, 2) of the body axis that u is, for each body
  /// Wave numbers of F_self, at most kMostWaveNumbers; empty: wave_numbers_about the first peak of S(q), by
  /// the rule of runs (see Correlations).
  std::vector<double> wave_numbers{};
  bool collective = false;  ///< ObservablesOptions::collective: positions may be wrapped, and bodies unknown
  BondOptions bonds{};
  /// Mean length along u of the bodies that have an orientation, for hexatic order; 0: not known.
  double axial_length = 0;
  /// Longest lag; 0: a quarter of the trajectory, or all of it at logarithmic times.
  double longest_lag = 0;
  /// First lag of the fits of decays, where ballistic motion has ended: a run uses five mean collision intervals.
  /// nullopt: the first lag from which the MSD grows as a power of time of at most 1.5 (up to 1.5 times that lag).
  std::optional<double> fit_from{};
  /// Called, unless empty, for each frame and each pair of frames; an exception that it throws ends the analysis.
  std::function<void()> poll{};
};

/// Results of stored frames, and the frames used.
struct StoredResults : Results {
  std::vector<double> wave_numbers;
  /// Frames used for correlations: the longest sequence of frames that are equally far apart in time, the first of
  /// several. S, g(r) and S(q) are from all frames.
  /// @{
  std::size_t first_frame = 0;
  std::size_t frames = 0;
  /// @}
  bool log_times = false;  ///< true if all frames were correlated with the first one, instead
  double fit_from = std::numeric_limits<double>::quiet_NaN();  ///< first lag of the fits of decays; NaN: not known
};

/// Computes averages over frames, and correlations over all pairs of frames that are a lag apart, at about 20 lags a
/// decade. Errors are standard errors over blocks as long as the longest lag (2 to 16 of them). At logarithmic times
/// (from the second on, frames ever further apart in time, and no more than a quarter of them equally far) the first
/// frame is correlated with each other one, and there are no errors. Results that the frames do not determine are
/// missing for the reason MissingReason::not_told: collisions, pressure, temperatures, rotational displacements, and if
/// velocities or rotations are missing, all results from these. Without unwrapped positions displacements are missing
/// for the reason not_unwrapped; if frames need not contain the same bodies, all correlations are missing for the
/// reason not_followed.
///
/// Memory: about 200 bytes a body and frame in addition to the frames. Throws std::invalid_argument for no frames,
/// numbers of bodies that differ, a box that is not positive, times that do not rise, a negative lag to fit from.
ED_EXPORT StoredResults analyze_frames(const std::vector<StoredFrame>& frames, const StoredFramesOptions& options);

}  // namespace ed
