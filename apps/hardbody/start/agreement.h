#pragma once

#include "config/config.h"

#include <ed/system.h>

namespace hardbody {

/// Relative difference between state and config that is regarded as rounding (of another machine's cube root, for
/// instance).
inline constexpr double kStateRounding = 1e-12;

/// Properties of the state that agree with its config.
struct Agreement {
  bool number = true;
  bool shape = true;
  bool dynamics = true;
};

Agreement compare(const ed::System& system, const Config& config);

}  // namespace hardbody
