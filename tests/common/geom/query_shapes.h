#pragma once

/// Shapes that every query is tested with.

#include "common/geom/shapes.h"

#include <geom/geom.h>

namespace geom_test {

inline const geom::Ellipsoid kNeedle({1, 1, 3});
inline const geom::Superellipsoid kBrick({1, 2, 1.5}, 0.5, 0.4);
inline const geom::Superellipsoid kOcta({1.2, 0.8, 1.5}, 1.4, 1.5);

/// Calls check(shape) for each of them.
template <class Check>
void for_each_shape(const Check& check) {
  check(kNeedle);
  check(geom::Ellipsoid({0.3, 1, 2}));
  check(kBrick);
  check(kOcta);
  check(WrappedEllipsoid{kNeedle});
}

}  // namespace geom_test
