#pragma once

#include <ed/shape.h>
#include <ed/system.h>

#include <vector>

namespace ed::internal {

/// Returns the bounding radius of each body.
inline std::vector<double> bounding_radii(const System& system) {
  std::vector<double> of_species, radii;
  of_species.reserve(system.species.size());
  radii.reserve(system.bodies.size());
  for (const Species& species : system.species) of_species.push_back(bounding_radius(species.shape));
  for (const Body& body : system.bodies) radii.push_back(of_species[static_cast<std::size_t>(body.species)]);
  return radii;
}

}  // namespace ed::internal
