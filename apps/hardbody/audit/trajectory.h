#pragma once

#include "trajectory/reader.h"

namespace hardbody {

/// Checks every frame that has positions and prints the result, for `hardbody check`. Returns 0 if every frame is
/// sound; 1 if one is not, or if something could not be tested, which the last line then says. Throws InputError.
int check_trajectory(const TrajectoryReader& reader);

}  // namespace hardbody
