#include "tessellation.h"

#include <geom/seeds.h>

#include <geom/distance.h>
#include <geom/kernel/any_body.h>

#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/narrowphase/distance.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <exception>
#include <memory>
#include <vector>

namespace geom {
namespace kernel {
namespace {

/// FCL's default, an absolute length.
constexpr double kFclTolerance = 1e-6;

/// FCL is not called for pairs whose gap is smaller, relative to their size. They touch, to rounding, and an assertion
/// of FCL's GJK (doSimplex2) then compares two sums of rounding errors.
constexpr double kLeastGap = 1e-12;

/// Returns a rotation by 1 radian about an arbitrary axis. The same assertion can also fail if FCL's GJK, which starts
/// along x, encounters supporting planes through the origin; for pairs that a user has aligned with the axes that is
/// likely.
const Eigen::Matrix3d& askew() {
  static const Eigen::Matrix3d R =
      Eigen::AngleAxisd(1, Eigen::Vector3d(0.41, -0.67, 0.53).normalized()).toRotationMatrix();
  return R;
}

fcl::Transform3d to_fcl(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position) {
  fcl::Transform3d X = fcl::Transform3d::Identity();
  X.linear() = askew() * rotation;
  X.translation() = askew() * position;
  return X;
}

constexpr int kVertices = 500;

/// Converts an ellipsoid to FCL's ellipsoid, anything else to a polytope; lengths over `unit`.
///
/// The polytope has no faces: FCL then finds its support points by testing all vertices. With faces it would walk along
/// the edges, which ends at the right vertex only if the mesh is convex, and a mesh between support points need not be.
std::shared_ptr<fcl::CollisionGeometryd> to_fcl(const SupportBody& body, double unit) {
  if (body.ellipsoid() != nullptr) return std::make_shared<fcl::Ellipsoidd>(body.ellipsoid()->semi_axes() / unit);
  static const std::vector<Eigen::Vector3d> directions = spiral_directions(kVertices);
  auto vertices = std::make_shared<std::vector<Eigen::Vector3d>>(inscribed_vertices(body, directions));
  for (Eigen::Vector3d& x : *vertices) x /= unit;
  return std::make_shared<fcl::Convexd>(vertices, 0, std::make_shared<const std::vector<int>>());
}

}  // namespace

WitnessPair fcl_seed(const SupportBody& a, const SupportBody& b, const DistanceResult& ours) {
  WitnessPair seed;
  const Eigen::Vector3d p_AB = b.pose().position() - a.pose().position();
  if (!(ours.status == DistanceStatus::separated && ours.distance > 0)) {
    // Declined: the bodies overlap deeply, or are so far apart that their distance overflows.
    const bool concentric = p_AB.norm() < a.inscribed_radius() + b.inscribed_radius();
    if (ours.status == DistanceStatus::overlapping || concentric) seed.status = SeedStatus::overlapping;
    return seed;
  }
  const double size = p_AB.norm() + a.bounding_radius() + b.bounding_radius();
  if (!(ours.distance >= kLeastGap * size)) return seed;
  const double unit = std::min(a.inscribed_radius(), b.inscribed_radius());
  const fcl::CollisionObjectd fcl_a(to_fcl(a, unit), to_fcl(a.pose().rotation(), Eigen::Vector3d::Zero()));
  const fcl::CollisionObjectd fcl_b(to_fcl(b, unit), to_fcl(b.pose().rotation(), p_AB / unit));
  fcl::DistanceRequestd request(/*enable_nearest_points_=*/true, /*enable_signed_distance=*/false);
  request.gjk_solver_type = fcl::GST_LIBCCD;
  request.distance_tolerance = kFclTolerance;
  fcl::DistanceResultd result;
  try {
    if (!(fcl::distance(&fcl_a, &fcl_b, request, result) >= 0)) return seed;
  } catch (const std::exception&) {
    return seed;
  }
  seed.point_a = a.pose().position() + unit * (askew().transpose() * result.nearest_points[0]);
  seed.point_b = a.pose().position() + unit * (askew().transpose() * result.nearest_points[1]);
  seed.status = SeedStatus::usable;
  return seed;
}

}  // namespace kernel

WitnessPair fcl_seed(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB) {
  return fcl_seed<Ellipsoid, Ellipsoid>(a, X_WA, b, X_WB);
}

WitnessPair fcl_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  return kernel::with_bodies(a, b, [&](const auto& s, const auto& t) { return fcl_seed(s, X_WA, t, X_WB); });
}

}  // namespace geom
