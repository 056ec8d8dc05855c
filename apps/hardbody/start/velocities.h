#pragma once

#include "config/config.h"
#include "trajectory/frame.h"

#include <ed/system.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hardbody {

/// Gives the bodies of a start the velocities of a frame. Those of the program's own frames are taken bit for bit if
/// masses and moments are the same. Otherwise each species gets translation, rotation and spin from the frame, each
/// rescaled to kT = 1. A kind of motion that the frame does not contain, or that is zero for the species, is drawn with
/// the config's seed. `order`: index in the frame of each body of the system. Returns a description of what was done,
/// for the report. Throws InputError.
std::string set_velocities(ed::System& system, const Config& config, const Frame& frame,
                           const std::vector<std::size_t>& order);

}  // namespace hardbody
