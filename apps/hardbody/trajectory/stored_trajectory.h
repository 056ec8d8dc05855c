#pragma once

#include "commands/commands.h"
#include "trajectory/reader.h"

#include <ed/stored_frames.h>

#include <cstddef>
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

/// Reads each `arguments.every`-th frame that has positions; they are unwrapped through all of them. Throws InputError.
StoredTrajectory read_trajectory(const TrajectoryReader& reader, const AnalyzeArguments& arguments);

}  // namespace hardbody
