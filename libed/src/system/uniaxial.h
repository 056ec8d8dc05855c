#pragma once

#include <ed/system.h>

#include <vector>

namespace ed::internal {

/// Returns whether UniaxialBodies can hold the species together: all are ellipsoids of revolution, capsules or spheres,
/// about axes that their inertia shares.
bool are_uniaxial(const std::vector<Species>& species);

/// Returns whether UniaxialBodies takes capsules and spheres as rods: there is a capsule, or all are spheres.
bool has_rods(const std::vector<Species>& species);

/// Returns whether the shape is an ellipsoid of revolution, a sphere or a capsule.
bool has_uniaxial_shape(const BodyShape& shape);

}  // namespace ed::internal
