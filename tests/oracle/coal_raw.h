#pragma once

/// Distances of Coal's own primitives, for benchmarks. Coal is not in Debian: it is used where CMake finds it, as in
/// the wheel of libcoal (docs/shapes.md).

#include <geom/geom.h>

#include <memory>

namespace geom_test {

/// Pair of Coal's primitives, made once for many queries. Cores are those of spheres, capsules, boxes, hulls, cylinders
/// and cones.
class CoalPrimitives {
 public:
  CoalPrimitives(const geom::kernel::CoreView& a, const geom::Pose& X_WA, const geom::kernel::CoreView& b,
                 const geom::Pose& X_WB);

  /// Returns the distance at Coal's defaults, cold, with nearest points.
  double distance() const;

 private:
  struct Objects;
  std::shared_ptr<const Objects> objects_;
};

}  // namespace geom_test
