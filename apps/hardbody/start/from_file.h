#pragma once

#include "config/config.h"
#include "config/start_additions.h"

#include <ed/system.h>

#include <optional>
#include <string>
#include <vector>

namespace hardbody {

/// State to start from, taken from a file.
struct FileStart {
  ed::System system;
  double packing_fraction = 0;       ///< packing fraction of the file's state
  bool compress = false;             ///< the config is denser: the state is to be compressed
  std::string report;                ///< one line that says what was taken from the file and what was changed
  std::vector<std::string> notices;  ///< notices of the reader about the frame, one line each
};

/// Returns the state in the config's file, with the bodies of the config, in their order. `frame`: frame of the file if
/// it has been read already. Positions and orientations are those of the file, bit for bit if the file is of this
/// program. Velocities are also taken if the bodies are those of the file bit for bit; otherwise they are rescaled to
/// kT = 1 (or drawn, if there are none). A state of a lower packing fraction than the config's is marked for
/// compression. Throws InputError if the bodies are different, the packing fraction is higher or cannot be reached, or
/// if bodies overlap and overlaps are not to be removed.
FileStart start_from_file(const Config& config, std::optional<StartFrame> frame = {});

}  // namespace hardbody
