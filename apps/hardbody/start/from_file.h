#pragma once

#include "config/config.h"
#include "config/start_additions.h"

#include <ed/system.h>

#include <optional>
#include <string>
#include <vector>

namespace hardbody {

/// State to start from.
struct FileStart {
  ed::System system;
  std::string report;                ///< what was taken from the file and what was changed, one line
  std::vector<std::string> notices;  ///< of the reader about the frame, one line each
};

/// Returns the state in the config's file, with the bodies of the config, in their order. `frame`: its frame if that
/// has been read already. Positions and orientations are those of the file, of our own files to every bit; velocities
/// too, where the bodies are those of the file to every bit, otherwise they are rescaled to kT = 1 (or drawn, where
/// there are none). Throws InputError if the bodies are others, if the packing fraction is another, and if bodies
/// overlap and are not to be mended.
FileStart start_from_file(const Config& config, std::optional<StartFrame> frame = {});

}  // namespace hardbody
