#include "oracle/fcl_raw.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk_libccd.h>
#include <fcl/narrowphase/distance.h>

#include <geom/kernel/any_body.h>

#include <cmath>
#include <deque>
#include <exception>
#include <memory>
#include <numbers>
#include <type_traits>

namespace geom_test {
namespace {

fcl::CollisionObjectd placed(const std::shared_ptr<fcl::CollisionGeometryd>& shape, const geom::Pose& X) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  transform.linear() = X.rotation();
  transform.translation() = X.position();
  return {shape, transform};
}

fcl::CollisionObjectd to_fcl(const geom::Ellipsoid& shape, const geom::Pose& X) {
  return placed(std::make_shared<fcl::Ellipsoidd>(shape.semi_axes()), X);
}

/// Makes a body of points without faces: FCL then looks at all points.
fcl::CollisionObjectd to_fcl(const std::vector<Eigen::Vector3d>& points, const geom::Pose& X) {
  return placed(std::make_shared<fcl::Convexd>(std::make_shared<const std::vector<Eigen::Vector3d>>(points), 0,
                                               std::make_shared<const std::vector<int>>()),
                X);
}

FclDistance ask(const fcl::CollisionObjectd& a, const fcl::CollisionObjectd& b, bool signed_distance) {
  fcl::DistanceRequestd request(/*enable_nearest_points_=*/true, signed_distance);
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::DistanceResultd result;
  try {
    const double d = fcl::distance(&a, &b, request, result);
    return {FclDistance::Outcome::answered, d, result.nearest_points[0], result.nearest_points[1]};
  } catch (const std::exception&) {
    return {FclDistance::Outcome::threw, 0, {}, {}};
  }
}

struct FedBody {
  const void* body;
  SupportFunction support;
};

void fed_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& fed = *static_cast<const FedBody*>(object);
  Eigen::Map<Eigen::Vector3d>(out->v) = fed.support(fed.body, Eigen::Map<const Eigen::Vector3d>(direction->v));
}

}  // namespace

struct FclPair::Objects {
  fcl::CollisionObjectd a;
  fcl::CollisionObjectd b;
};

FclPair::FclPair(const geom::Ellipsoid& a, const geom::Pose& X_WA, const geom::Ellipsoid& b, const geom::Pose& X_WB)
    : objects_(std::make_shared<const Objects>(Objects{to_fcl(a, X_WA), to_fcl(b, X_WB)})) {}

FclDistance FclPair::distance(bool signed_distance) const {
  return ask(objects_->a, objects_->b, signed_distance);
}

FclDistance fcl_distance(const geom::Ellipsoid& a, const geom::Pose& X_WA, const geom::Ellipsoid& b,
                         const geom::Pose& X_WB, bool signed_distance) {
  return ask(to_fcl(a, X_WA), to_fcl(b, X_WB), signed_distance);
}

namespace {

/// Makes FCL's cylinder or cone, which is symmetric about the origin in height.
fcl::CollisionObjectd round_primitive(const geom::kernel::CoreView& core, const geom::Pose& X) {
  const auto& [low, high] = core.disc;
  const double length = high.z - low.z;
  const geom::Pose middle(X.rotation(), X.position() + 0.5 * (low.z + high.z) * X.rotation().col(2));
  if (high.radius == low.radius) return placed(std::make_shared<fcl::Cylinderd>(low.radius, length), middle);
  return placed(std::make_shared<fcl::Coned>(low.radius, length), middle);
}

/// Makes FCL's primitive of a core with a ball: of a sphere, a capsule, a box, a hull, a cylinder or a cone, not of
/// rounded ones.
fcl::CollisionObjectd primitive(const geom::kernel::CoreView& core, const geom::Pose& X) {
  using geom::kernel::CoreKind;
  if (core.kind == CoreKind::point) return placed(std::make_shared<fcl::Sphered>(core.radius), X);
  if (core.kind == CoreKind::segment) {
    return placed(std::make_shared<fcl::Capsuled>(core.radius, 2 * core.half.z()), X);
  }
  if (core.kind == CoreKind::box) return placed(std::make_shared<fcl::Boxd>(2 * core.half), X);
  if (core.kind == CoreKind::frustum) return round_primitive(core, X);
  const auto points = std::make_shared<std::vector<fcl::Vector3d>>();
  for (Eigen::Index k = 0; k < core.hull->vertices.rows(); ++k) points->emplace_back(core.hull->vertices.row(k));
  const auto faces = std::make_shared<std::vector<int>>();
  for (const std::vector<int>& face : core.hull->faces) {
    faces->push_back(static_cast<int>(face.size()));
    faces->insert(faces->end(), face.begin(), face.end());
  }
  return placed(std::make_shared<fcl::Convexd>(points, static_cast<int>(core.hull->faces.size()), faces), X);
}

}  // namespace

struct FclPrimitives::Objects {
  fcl::CollisionObjectd a;
  fcl::CollisionObjectd b;
};

FclPrimitives::FclPrimitives(const geom::kernel::CoreView& a, const geom::Pose& X_WA, const geom::kernel::CoreView& b,
                             const geom::Pose& X_WB)
    : objects_(std::make_shared<const Objects>(Objects{primitive(a, X_WA), primitive(b, X_WB)})) {}

FclDistance FclPrimitives::distance() const {
  return ask(objects_->a, objects_->b, /*signed_distance=*/false);
}

struct FclScene::Objects {
  std::deque<fcl::CollisionObjectd> all;
  fcl::DynamicAABBTreeCollisionManagerd tree;
};

FclScene::FclScene() : objects_(std::make_shared<Objects>()) {}

void FclScene::add(const geom::Shape& shape, const geom::Pose& X_WB) {
  objects_->all.push_back(geom::kernel::with_body(shape, [&](const auto& body) -> fcl::CollisionObjectd {
    using Body = std::decay_t<decltype(body)>;
    if constexpr (geom::CoreShape<Body>) {
      return primitive(body.core(), X_WB);
    } else if constexpr (std::is_same_v<Body, geom::Ellipsoid>) {
      return to_fcl(body, X_WB);
    } else {
      std::vector<Eigen::Vector3d> points;
      constexpr int kRings = 8;
      for (int ring = 0; ring <= kRings; ++ring) {
        const double polar = std::numbers::pi * ring / kRings;
        for (int k = 0; k < 2 * kRings; ++k) {
          const double angle = std::numbers::pi * k / kRings;
          const Eigen::Vector3d n(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle),
                                  std::cos(polar));
          points.push_back(geom::Support(body.support(n)).point);
          if (ring == 0 || ring == kRings) break;
        }
      }
      return primitive(geom::ConvexPolyhedron(points).core(), X_WB);
    }
  }));
}

void FclScene::build() {
  std::vector<fcl::CollisionObjectd*> pointers;
  for (fcl::CollisionObjectd& object : objects_->all) {
    object.computeAABB();
    pointers.push_back(&object);
  }
  objects_->tree.registerObjects(pointers);
  objects_->tree.setup();
}

void FclScene::move(const std::vector<geom::Pose>& X_WB) {
  for (std::size_t k = 0; k < X_WB.size(); ++k) {
    fcl::CollisionObjectd& object = objects_->all[k];
    object.setRotation(X_WB[k].rotation());
    object.setTranslation(X_WB[k].position());
    object.computeAABB();
  }
  objects_->tree.update();
}

std::vector<double> FclScene::pairs_within(double cutoff) const {
  struct Found {
    double cutoff;
    std::vector<double> distances;
  } found{cutoff, {}};
  // `limit`: distance of boxes from which on the tree leaves pairs out.
  const auto visit = [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data, double& limit) {
    auto& all = *static_cast<Found*>(data);
    const FclDistance d = ask(*a, *b, /*signed_distance=*/false);
    if (d.distance <= all.cutoff) all.distances.push_back(d.distance);
    limit = all.cutoff;
    return false;
  };
  objects_->tree.distance(&found, visit);
  return found.distances;
}

FclDistance fcl_distance(const std::vector<Eigen::Vector3d>& a, const geom::Pose& X_WA,
                         const std::vector<Eigen::Vector3d>& b, const geom::Pose& X_WB) {
  return ask(to_fcl(a, X_WA), to_fcl(b, X_WB), /*signed_distance=*/false);
}

double fcl_gjk_distance(const void* a, const void* b, SupportFunction support) {
  constexpr unsigned kIterations = 1000;
  constexpr double kTolerance = 1e-6;
  FedBody fed_a{a, support};
  FedBody fed_b{b, support};
  double distance = -1;
  fcl::Vector3d p_a, p_b;
  const bool apart = fcl::detail::GJKDistance<double>(&fed_a, fed_support, &fed_b, fed_support, kIterations, kTolerance,
                                                      &distance, &p_a, &p_b);
  return apart ? distance : -1;
}

}  // namespace geom_test
