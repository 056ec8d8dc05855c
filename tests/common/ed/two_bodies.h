#pragma once

/// Systems of one or two bodies.

#include <ed/system.h>

#include <geom/ellipsoid.h>

#include <Eigen/Core>

namespace two_bodies {

inline ed::Species sphere() {
  return ed::paper_species(geom::Ellipsoid({1, 1, 1}));
}

/// Two bodies in a box, the first at the origin.
inline ed::System two_bodies(const ed::Species& species, double box, const Eigen::Vector3d& r) {
  ed::System system;
  system.box = box;
  system.species = {species};
  system.bodies.resize(2);
  system.bodies[1].position = r;
  return system;
}

}  // namespace two_bodies
