#pragma once

/// Comparison of a sweep with the one that its directory holds.

#include "sweep/file.h"

#include <filesystem>

namespace hardbody {

/// Checks that a sweep continues the one that `directory` holds: the same config, the same or more points of the same
/// keys, as many or more replicas, no other names of points, and along a chain no other start of a point that was
/// there. Throws InputError, naming the first difference.
void check_continues(const SweepFile& held, const SweepFile& now, const std::filesystem::path& directory);

}  // namespace hardbody
