#pragma once

/// Reading of [start], and of what a config leaves to the file that it starts from.

#include "config/config.h"
#include "io/toml_document.h"
#include "trajectory/frame.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

/// [start] of a document, if it has a file. Throws InputError.
std::optional<StartFile> read_start_file(const TomlDocument& document);

/// Frame of a file that a run starts from.
struct StartFrame {
  Frame frame;
  std::uint64_t number;
  bool cut_off;  ///< the file ends before its last frame does
};

/// Reads the frame that `start` names, or the last one with positions. Throws InputError.
StartFrame read_start_frame(const StartFile& start);

/// Returns the edge of the frame's box. Throws InputError unless it is a cube; `file` is its name in the message.
double box_of(const Frame& frame, const std::string& file);

/// Returns the bodies of each group, in the order of the groups' numbers.
std::vector<std::vector<std::size_t>> groups_of(const Frame& frame);

/// What a config that starts from a file leaves to it: text to stand at the end of the config, and values to lay over.
struct StartAdditions {
  std::string text;                    ///< [[species]]
  std::vector<std::string> overrides;  ///< section.key=value

  bool empty() const { return text.empty() && overrides.empty(); }
};

/// The frame's number, the number of bodies, their shapes, masses and moments, the packing fraction: those of them that
/// the document does not say. The file is read only if there are any. Throws InputError.
StartAdditions additions_from(const StartFile& start, const TomlDocument& document);

}  // namespace hardbody
