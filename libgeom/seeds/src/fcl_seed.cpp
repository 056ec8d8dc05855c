#include <geom/seeds.h>

#include <geom/distance.h>

#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <exception>
#include <memory>

namespace geom {
namespace {

/// FCL's default, an absolute length.
constexpr double kFclTolerance = 1e-6;

fcl::Transform3d to_fcl(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position) {
  fcl::Transform3d X = fcl::Transform3d::Identity();
  X.linear() = rotation;
  X.translation() = position;
  return X;
}

}  // namespace

WitnessPair fcl_seed(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB) {
  const DistanceResult ours = distance(a, X_WA, b, X_WB);
  WitnessPair seed;
  // Of ellipsoids `distance` answers every separated pair: what it declines overlaps deeply.
  if (!(ours.status == DistanceStatus::separated && ours.distance > 0)) {
    seed.status = SeedStatus::overlapping;
    return seed;
  }
  const double unit = std::min(a.inscribed_radius(), b.inscribed_radius());
  const Eigen::Vector3d p_AB = X_WB.position() - X_WA.position();
  const fcl::CollisionObjectd fcl_a(std::make_shared<fcl::Ellipsoidd>(a.semi_axes() / unit),
                                    to_fcl(X_WA.rotation(), Eigen::Vector3d::Zero()));
  const fcl::CollisionObjectd fcl_b(std::make_shared<fcl::Ellipsoidd>(b.semi_axes() / unit),
                                    to_fcl(X_WB.rotation(), p_AB / unit));
  fcl::DistanceRequestd request(/*enable_nearest_points_=*/true, /*enable_signed_distance=*/false);
  request.gjk_solver_type = fcl::GST_LIBCCD;
  request.distance_tolerance = kFclTolerance;
  fcl::DistanceResultd result;
  try {
    if (!(fcl::distance(&fcl_a, &fcl_b, request, result) >= 0)) return seed;
  } catch (const std::exception&) {
    return seed;
  }
  seed.point_a = X_WA.position() + unit * result.nearest_points[0];
  seed.point_b = X_WA.position() + unit * result.nearest_points[1];
  if (seed.point_a.allFinite() && seed.point_b.allFinite()) seed.status = SeedStatus::usable;
  return seed;
}

}  // namespace geom
