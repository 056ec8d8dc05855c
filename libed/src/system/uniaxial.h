#pragma once

#include <ed/system.h>

namespace ed::internal {

/// Whether the species is one of ellipsoids of revolution about an axis that their inertia shares (UniaxialBodies).
bool is_uniaxial(const Species& species);

}  // namespace ed::internal
