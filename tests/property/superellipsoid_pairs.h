#pragma once

/// Sets of pairs of superellipsoids whose answer is known (geom_superellipsoid_distance_test.cpp).

#include "common/geom/manufactured.h"
#include "common/geom/random.h"
#include "common/geom/superellipsoid_sets.h"

#include <geom/geom.h>

#include <array>
#include <cstddef>

namespace geom {

using Eigen::Vector3d;
using geom_test::any_exponent;
using geom_test::choose;
using geom_test::kExponents;
using geom_test::Orientation;
using geom_test::PairSet;
using geom_test::place;
using geom_test::Random;

struct SetTraits {
  PairSet set;
  const char* name;
  double depth_tolerance;  ///< excess of the depths of overlaps, relative to the size of the pair
  double depth_bound;      ///< error bound of overlaps, relative to it: kDepthGap, but for parallel faces
  double off_surface;  ///< offset of witness points of bodies apart; normals of faces are those of vertices for e > 1
};

inline constexpr std::array<SetTraits, 5> kSets{{{PairSet::random_normal, "random normal", 1e-12, kDepthGap, 1e-10},
                                                 {PairSet::random_point, "random point", 1e-12, kDepthGap, 1e-10},
                                                 {PairSet::aligned, "aligned copies", 1e-12, kDepthGap, 1e-10},
                                                 {PairSet::edges, "edges and vertices", 1e-12, kDepthGap, 1e-10},
                                                 {PairSet::faces, "faces", 2e-10, 1e-7, 1e-9}}};

/// Error of the distance of bodies that are apart, relative to the size of the pair: distance.h promises it.
inline constexpr double kTolerance = 1e-12;

struct Bodies {
  Superellipsoid a, b;

  double radii() const { return a.bounding_radius() + b.bounding_radius(); }
};

inline Vector3d random_axes(long k, Random& random) {
  if (k % 3 == 0) return {1, 1, 1};
  if (k % 3 == 1) return {1, 1, 2};
  return {1, random.uniform(0.6, 1.6), random.uniform(0.4, 2.4)};
}

/// B is A's copy.
inline Bodies copies(long k, double e1, double e2, Random& random) {
  const Superellipsoid shape(random_axes(k, random), e1, e2);
  return {shape, shape};
}

/// B has other exponents and proportions, a third of the time those of an ellipsoid, and is up to 20 times smaller or
/// larger.
inline Bodies unlike(long k, double e1, double e2, Random& random) {
  const Superellipsoid a(random_axes(k, random), e1, e2);
  const Vector3d axes = random.log_uniform(0.05, 20) * random_axes(k / 3, random);
  if (random.uniform() < 1.0 / 3) return {a, Superellipsoid(axes, 1, 1)};
  const double e = any_exponent(random);
  return {a, Superellipsoid(axes, e, any_exponent(random))};
}

/// Another one for each cell of exponents and each set.
inline unsigned seed_of(std::size_t cell, PairSet set) {
  return static_cast<unsigned>(cell * kSets.size()) + static_cast<unsigned>(set) + 1;
}

/// check(e1, e2, random), once for each e1 and e2.
template <class Check>
void for_each_cell(PairSet set, const Check& check) {
  std::size_t cell = 0;
  for (const double e1 : kExponents) {
    for (const double e2 : kExponents) {
      Random random(seed_of(cell++, set));
      check(e1, e2, random);
    }
  }
}

}  // namespace geom
