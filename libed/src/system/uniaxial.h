#pragma once

#include <ed/system.h>

namespace ed::internal {

/// Returns whether the species is an ellipsoid of revolution about an axis that its inertia shares (UniaxialBodies).
bool is_uniaxial(const Species& species);

}  // namespace ed::internal
