#include "oracle/fcl_raw.h"

#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/narrowphase/distance.h>

#include <exception>
#include <memory>

namespace geom_test {
namespace {

fcl::CollisionObjectd to_fcl(const geom::Ellipsoid& shape, const geom::Pose& X) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  transform.linear() = X.rotation();
  transform.translation() = X.position();
  return {std::make_shared<fcl::Ellipsoidd>(shape.semi_axes()), transform};
}

}  // namespace

FclDistance fcl_distance(const geom::Ellipsoid& a, const geom::Pose& X_WA, const geom::Ellipsoid& b,
                         const geom::Pose& X_WB, bool signed_distance) {
  const fcl::CollisionObjectd fcl_a = to_fcl(a, X_WA);
  const fcl::CollisionObjectd fcl_b = to_fcl(b, X_WB);
  fcl::DistanceRequestd request(/*enable_nearest_points_=*/true, signed_distance);
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::DistanceResultd result;
  try {
    const double d = fcl::distance(&fcl_a, &fcl_b, request, result);
    return {FclDistance::Outcome::answered, d, result.nearest_points[0], result.nearest_points[1]};
  } catch (const std::exception&) {
    return {FclDistance::Outcome::threw, 0, {}, {}};
  }
}

}  // namespace geom_test
