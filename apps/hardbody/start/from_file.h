#pragma once

#include "config/config.h"
#include "trajectory/frame.h"
#include "io/toml_document.h"

#include <ed/system.h>

#include <string>
#include <vector>

namespace hardbody {

/// [start] of a document, if it has a file. Throws InputError.
std::optional<StartFile> read_start_file(const TomlDocument& document);

/// What a config that starts from a file leaves to it: text to stand at the end of the config, and values to lay over.
struct StartAdditions {
  std::string text;                    ///< [[species]]
  std::vector<std::string> overrides;  ///< section.key=value

  bool empty() const { return text.empty() && overrides.empty(); }
};

/// The frame's number, the number of bodies, their shapes, masses and moments, the packing fraction: those of them that
/// the document does not say. The file is read only if there are any. Throws InputError.
StartAdditions additions_from(const StartFile& start, const TomlDocument& document);

/// A state to start from.
struct FileStart {
  ed::System system;
  std::string report;                ///< what was taken from the file and what was changed, one line
  std::vector<std::string> notices;  ///< of the reader about the frame, one line each
};

/// The state in the config's file, with the bodies of the config, in their order. Positions and orientations are those
/// of the file, of our own files to every bit; velocities too, where the bodies are those of the file to every bit,
/// otherwise they are rescaled to kT = 1 (or drawn, where there are none). Throws InputError if the bodies are others,
/// if the packing fraction is another, and if bodies overlap and are not to be mended.
FileStart start_from_file(const Config& config);

}  // namespace hardbody
