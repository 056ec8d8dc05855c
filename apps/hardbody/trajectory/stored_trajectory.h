#pragma once

#include "trajectory/reader.h"

#include <ed/stored_frames.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

/// Frames of a file in the form that `analyze` needs, with their provenance.
struct StoredTrajectory {
  std::vector<ed::StoredFrame> frames;
  ed::StoredFramesOptions options;
  bool exact = false;                 ///< true if all frames hold exact states of this program
  std::vector<double> energy;         ///< energy of each frame; NaN: not known
  std::size_t in_file = 0;            ///< number of complete frames in the file
  std::size_t without_positions = 0;  ///< number of frames that were left out because they contain only logged values
  /// Source of unwrapped positions: "image flags", "unwrapped columns", "positions outside the box", "nearest images";
  /// empty: not known, for the reason `not_unwrapped`.
  std::string unwrapped_by;
  std::string not_unwrapped;
  std::string not_followed;  ///< reason for which bodies cannot be followed from frame to frame; empty: they can
  std::vector<std::string> notices;  ///< notices of the reader, one line each
};

/// Options of read_trajectory().
struct ReadingOptions {
  int every = 1;                      ///< stride: each `every`-th frame that has positions is taken
  std::optional<double> time_step;    ///< time between two steps; nullopt: the stored times
  std::optional<double> longest_lag;  ///< longest lag; nullopt: a quarter of the trajectory
};

/// Reads frames of a trajectory. Positions are unwrapped through all frames, including those that are left out. Throws
/// InputError.
StoredTrajectory read_trajectory(const TrajectoryReader& reader, const ReadingOptions& options);

}  // namespace hardbody
