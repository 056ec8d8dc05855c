#pragma once

#include "trajectory/reader.h"

namespace hardbody {

/// Audits every frame that has positions and prints what it found, for `hardbody check`. 0: every frame is sound; 1:
/// one is not, or something was not looked at, which the last line then says. Throws InputError.
int check_trajectory(const TrajectoryReader& reader);

}  // namespace hardbody
