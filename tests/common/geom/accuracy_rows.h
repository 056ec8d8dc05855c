#pragma once

/// Rows of the table of docs/accuracy.md: pairs of shapes, and gaps.

#include "common/geom/random.h"

#include <geom/geom.h>

#include <Eigen/Core>

#include <array>
#include <cstdio>

namespace geom_test {

/// Asserted accuracy: the contract of distance.h, relative to the size of the pair.
inline constexpr double kEllipsoidAccuracy = 1e-13;
inline constexpr double kSuperellipsoidAccuracy = 1e-12;

inline constexpr std::array kGapsApart{1.0, 1e-3, 1e-6, 1e-9};
inline constexpr std::array kOverlaps{-1e-6, -1e-4, -1e-3};

inline Eigen::Vector3d random_axes(Random& random) {
  return {random.uniform(0.4, 1), random.uniform(0.4, 1), 1};
}

/// Calls rows(name, accuracy, make_a, make_b) for each pair of shapes; make_a(random) is the next A.
template <class Rows>
void for_each_pair_of_shapes(const Rows& rows) {
  const auto spheroid = [](double X0) { return [X0](Random&) { return geom::Ellipsoid({1, 1, X0}); }; };
  rows("spheres", kEllipsoidAccuracy, spheroid(1), spheroid(1));
  rows("spheroids, X0 = 0.1", kEllipsoidAccuracy, spheroid(0.1), spheroid(0.1));
  rows("spheroids, X0 = 3", kEllipsoidAccuracy, spheroid(3), spheroid(3));
  rows("spheroids, X0 = 10", kEllipsoidAccuracy, spheroid(10), spheroid(10));
  rows("spheroids, X0 = 0.1 and 10", kEllipsoidAccuracy, spheroid(0.1), spheroid(10));
  const auto biaxial = [](Random& random) { return random.biaxial(10); };
  rows("ellipsoids, ratios to 10", kEllipsoidAccuracy, biaxial, biaxial);
  const auto barr = [](double e1, double e2) {
    return [=](Random& random) { return geom::Superellipsoid(random_axes(random), e1, e2); };
  };
  for (const double e : {0.2, 0.3, 0.5, 0.7, 1.0, 1.3, 1.6}) {
    char name[64];
    (void)std::snprintf(name, sizeof name, "superellipsoids, e = %g", e);
    rows(name, e == 1 ? kEllipsoidAccuracy : kSuperellipsoidAccuracy, barr(e, e), barr(e, e));
  }
  rows("superellipsoids, e1 = 0.3, e2 = 1.3", kSuperellipsoidAccuracy, barr(0.3, 1.3), barr(0.3, 1.3));
  rows("superellipsoids, e1 = 1.3, e2 = 0.3", kSuperellipsoidAccuracy, barr(1.3, 0.3), barr(1.3, 0.3));
  const auto any = [](Random& random) {
    const Eigen::Vector3d axes = random_axes(random);
    const double e1 = random.uniform(0.2, 1.6);
    return geom::Superellipsoid(axes, e1, random.uniform(0.2, 1.6));
  };
  rows("superellipsoids, e1, e2 = 0.2 to 1.6", kSuperellipsoidAccuracy, any, any);
  rows("ellipsoid and superellipsoid", kSuperellipsoidAccuracy, biaxial, any);
}

}  // namespace geom_test
