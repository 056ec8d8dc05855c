#pragma once

#include "config/config.h"

#include <ed/system.h>

namespace hardbody {

/// The last state of the run that the config starts from. Throws InputError if there is none, or it is not one of the
/// config's bodies at its packing fraction or below.
ed::System read_origin_state(const Config& config);

}  // namespace hardbody
