#pragma once

/// Families of bodies other than ellipsoids of revolution, for the tests of the event loop: volume 4 pi / 3 each,
/// uniform density, kT = m = 1.

#include <ed/ed.h>

#include <geom/ellipsoid.h>
#include <geom/superellipsoid.h>

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace ed_test {

/// Returns a body with these proportions, scaled to the volume of the unit sphere.
inline geom::Superellipsoid superellipsoid(const Eigen::Vector3d& axes, double e1, double e2) {
  const double scale = std::cbrt(4.18879020478639098 / geom::Superellipsoid(axes, e1, e2).volume());
  return {scale * axes, e1, e2};
}

inline geom::Ellipsoid ellipsoid(const Eigen::Vector3d& axes) {
  return geom::Ellipsoid(axes / std::cbrt(axes.prod()));
}

/// Returns the body |x|^p + |y|^p + |z|^p <= 1.
inline geom::Superellipsoid superball(double p) {
  return superellipsoid({1, 1, 1}, 2 / p, 2 / p);
}

struct Family {
  std::string name;
  std::vector<ed::Component> components;
};

inline Family pure(const std::string& name, const ed::BodyShape& shape, int number) {
  return {name, {{ed::uniform_species(shape), number}}};
}

/// Returns one family of each kind; `number` of bodies in all.
inline std::vector<Family> families(int number) {
  std::vector<Family> all;
  all.push_back(pure("superballs, p = 4", superball(4), number));
  all.push_back(pure("superellipsoids 1 : 1 : 2, e = 0.5", superellipsoid({1, 1, 2}, 0.5, 0.5), number));
  all.push_back(pure("superellipsoids 1 : 0.8 : 0.6, e = 0.7, 1.3", superellipsoid({1, 0.8, 0.6}, 0.7, 1.3), number));
  all.push_back(pure("round superellipsoids 1 : 1 : 0.5, e = 0.4, 1", superellipsoid({1, 1, 0.5}, 0.4, 1), number));
  all.push_back(pure("biaxial ellipsoids 1 : 0.8 : 0.5", ellipsoid({1, 0.8, 0.5}), number));
  all.push_back(pure("cubes, e = 0.25", superball(8), number));
  all.push_back(pure("octahedra, e = 1.6", superball(1.25), number));
  Family mixture{"a mixture", {}};
  mixture.components.push_back({ed::uniform_species(ellipsoid({1, 1, 2}), 1.5), number / 2});
  mixture.components.push_back({ed::uniform_species(superball(3)), number / 4});
  mixture.components.push_back({ed::uniform_species(ellipsoid({1, 0.8, 0.5}), 0.7), number - number / 2 - number / 4});
  all.push_back(mixture);
  return all;
}

inline ed::System start(const Family& family, double packing_fraction, std::uint64_t seed = 1) {
  ed::StartOptions options;
  options.packing_fraction = packing_fraction;
  options.seed = seed;
  return ed::random_start(family.components, options);
}

}  // namespace ed_test
