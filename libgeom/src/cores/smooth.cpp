#include "cores/contact.h"
#include "cores/polytope_smooth.h"

#include <geom/distance.h>

namespace geom::kernel {
namespace {

template <class Smooth>
DistanceResult to_smooth(const CoreBody& a, const Pose& X_WA, const Smooth& b, const Pose& X_WB,
                         const DistanceOptions& options) {
  const CoreView core = a.bare().core();
  if (core.kind == CoreKind::box || core.kind == CoreKind::hull) {
    const DistanceResult r = polytope_to_smooth(core, X_WA, b, X_WB, options);
    if (r.status != DistanceStatus::not_converged) return with_skins(r, a.core().radius, 0);
  }
  const auto turned = [](const Pose& X) { return unchecked_pose(without_dust(X.rotation()), X.position()); };
  return core_to_body(a, turned(X_WA), b, turned(X_WB), options);
}

}  // namespace

DistanceResult core_to_smooth(const CoreBody& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                              const DistanceOptions& options) {
  return to_smooth(a, X_WA, b, X_WB, options);
}

DistanceResult core_to_smooth(const CoreBody& a, const Pose& X_WA, const Superellipsoid& b, const Pose& X_WB,
                              const DistanceOptions& options) {
  return to_smooth(a, X_WA, b, X_WB, options);
}

}  // namespace geom::kernel
