#include "oracle/coal_raw.h"

#include <coal/distance.h>
#include <coal/shape/convex.h>
#include <coal/shape/geometric_shapes.h>

#include <vector>

namespace geom_test {
namespace {

using geom::kernel::CoreKind;
using geom::kernel::CoreView;

struct Placed {
  std::shared_ptr<coal::CollisionGeometry> shape;
  coal::Transform3s at;
};

std::shared_ptr<coal::CollisionGeometry> hull_of(const geom::kernel::Hull& hull) {
  auto points = std::make_shared<std::vector<coal::Vec3s>>();
  for (Eigen::Index k = 0; k < hull.vertices.rows(); ++k) points->push_back(hull.vertices.row(k).transpose());
  auto triangles = std::make_shared<std::vector<coal::Triangle>>();
  for (const std::vector<int>& face : hull.faces) {
    for (std::size_t k = 1; k + 1 < face.size(); ++k) {
      triangles->emplace_back(static_cast<std::size_t>(face[0]), static_cast<std::size_t>(face[k]),
                              static_cast<std::size_t>(face[k + 1]));
    }
  }
  const auto count = [](const auto& list) { return static_cast<unsigned>(list->size()); };
  return std::make_shared<coal::Convex<coal::Triangle>>(points, count(points), triangles, count(triangles));
}

/// Returns Coal's shape; Coal's cylinders and cones are symmetric about the origin in height.
Placed primitive(const CoreView& core, const geom::Pose& X) {
  double middle = 0;
  std::shared_ptr<coal::CollisionGeometry> shape;
  switch (core.kind) {
    case CoreKind::point:
      shape = std::make_shared<coal::Sphere>(core.radius);
      break;
    case CoreKind::segment:
      shape = std::make_shared<coal::Capsule>(core.radius, 2 * core.half.z());
      break;
    case CoreKind::box:
      shape = std::make_shared<coal::Box>(2 * core.half);
      break;
    case CoreKind::hull:
      shape = hull_of(*core.hull);
      break;
    case CoreKind::frustum: {
      const auto& [low, high] = core.disc;
      middle = 0.5 * (low.z + high.z);
      if (high.radius == low.radius) {
        shape = std::make_shared<coal::Cylinder>(low.radius, high.z - low.z);
      } else {
        shape = std::make_shared<coal::Cone>(low.radius, high.z - low.z);
      }
      break;
    }
  }
  return {shape, coal::Transform3s(X.rotation(), X.position() + middle * X.rotation().col(2))};
}

}  // namespace

struct CoalPrimitives::Objects {
  Placed a;
  Placed b;
};

CoalPrimitives::CoalPrimitives(const CoreView& a, const geom::Pose& X_WA, const CoreView& b, const geom::Pose& X_WB)
    : objects_(std::make_shared<const Objects>(Objects{primitive(a, X_WA), primitive(b, X_WB)})) {}

double CoalPrimitives::distance() const {
  const coal::DistanceRequest request;
  coal::DistanceResult result;
  return coal::distance(objects_->a.shape.get(), objects_->a.at, objects_->b.shape.get(), objects_->b.at, request,
                        result);
}

}  // namespace geom_test
