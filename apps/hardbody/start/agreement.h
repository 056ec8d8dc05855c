#pragma once

#include "config/config.h"

#include <ed/system.h>

namespace hardbody {

/// Relative difference between state and config that is rounding (of another machine's cube root, say).
inline constexpr double kStateRounding = 1e-12;

/// What of the state is as its config says.
struct Agreement {
  bool number = true;
  bool shape = true;
  bool dynamics = true;
};

Agreement compare(const ed::System& system, const Config& config);

}  // namespace hardbody
