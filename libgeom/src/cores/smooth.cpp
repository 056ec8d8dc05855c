#include <geom/distance.h>

namespace geom::kernel {

DistanceResult core_to_smooth(const CoreBody& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                              const DistanceOptions& options) {
  return core_to_body(a, X_WA, b, X_WB, options);
}

DistanceResult core_to_smooth(const CoreBody& a, const Pose& X_WA, const Superellipsoid& b, const Pose& X_WB,
                              const DistanceOptions& options) {
  return core_to_body(a, X_WA, b, X_WB, options);
}

}  // namespace geom::kernel
