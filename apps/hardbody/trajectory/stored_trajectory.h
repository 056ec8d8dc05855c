#pragma once

#include "trajectory/reader.h"

#include <ed/stored_frames.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

/// Frames of a file as `analyze` takes them, and what they are of.
struct StoredTrajectory {
  std::vector<ed::StoredFrame> frames;
  ed::StoredFramesOptions options;
  std::vector<double> energy;         ///< of each frame; NaN: not known
  std::size_t in_file = 0;            ///< whole frames
  std::size_t without_positions = 0;  ///< frames that were left out: there is nothing in them but logged values
  /// Source of unwrapped positions: "image flags", "unwrapped columns", "positions outside the box", "nearest images";
  /// empty: not known, for the reason `not_unwrapped`.
  std::string unwrapped_by;
  std::string not_unwrapped;
  std::string not_followed;  ///< reason for which bodies cannot be followed from frame to frame; empty: they can
  std::vector<std::string> notices;  ///< of the reader, one line each
};

/// Options of read_trajectory().
struct ReadingOptions {
  int every = 1;                      ///< frames taken: each `every`-th one that has positions
  std::optional<double> time_step;    ///< time between two steps; nothing: the times that are stored
  std::optional<double> longest_lag;  ///< nothing: a quarter of the trajectory
};

/// Reads frames of a trajectory. Positions are unwrapped through all frames, those that are left out too. Throws
/// InputError.
StoredTrajectory read_trajectory(const TrajectoryReader& reader, const ReadingOptions& options);

}  // namespace hardbody
