#pragma once

#include "config/config.h"
#include "trajectory/frame.h"

#include <ed/system.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hardbody {

/// Gives the bodies of a start the velocities of a frame. Those of the program's own frames are taken to every bit
/// where masses and moments are the same. Otherwise each species gets translation, rotation and spin from the frame,
/// each rescaled to kT = 1, or, where the frame does not know that kind of motion or the species has none of it, drawn
/// with the config's seed. `order`: which body of the frame each body of the system is. Returns what was done, for the
/// report. Throws InputError.
std::string set_velocities(ed::System& system, const Config& config, const Frame& frame,
                           const std::vector<std::size_t>& order);

}  // namespace hardbody
