#pragma once

#include <ed/system.h>

namespace ed::internal {

/// Returns whether the shape is an ellipsoid of revolution or a sphere.
bool has_uniaxial_shape(const BodyShape& shape);

/// Returns whether the species is an ellipsoid of revolution or a sphere, about an axis that its inertia shares
/// (UniaxialBodies).
bool is_uniaxial(const Species& species);

}  // namespace ed::internal
