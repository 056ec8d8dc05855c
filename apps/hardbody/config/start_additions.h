#pragma once

/// Reading of what a config leaves to the file that it starts from.

#include "config/config.h"
#include "io/toml_document.h"
#include "trajectory/frame.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

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

/// Returns the document with what it leaves to the file that it starts from: the frame's number, the number of bodies,
/// their shapes, masses and moments, the packing fraction. The file is read, into `frame`, only if the document leaves
/// any of them. Throws InputError.
TomlDocument completed(TomlDocument document, const StartFile& start, std::optional<StartFrame>& frame);

}  // namespace hardbody
