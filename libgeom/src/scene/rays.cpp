#include "scene/best.h"
#include "scene/bodies.h"

#include <geom/kernel/refuse.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace geom {

using Eigen::Vector3d;
using scene::Best;
using scene::Body;
using scene::Box3;

namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Ray, or a part of it.
struct Ray {
  Vector3d origin, direction;

  /// Returns a lower bound of the t, from `first` to `last`, at which the ray is in a box; infinite if it never is.
  double enters(const Box3& box, double first, double last) const {
    // Rounding moves the ray by less than this, seen from the box.
    const double size =
        std::max({origin.cwiseAbs().maxCoeff(), box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff()});
    const Box3 wide = box.grown(16 * kEpsilon * size);
    for (int k = 0; k < 3; ++k) {
      if (direction[k] == 0) {
        if (origin[k] < wide.low[k] || origin[k] > wide.high[k]) return kEndless;
        continue;
      }
      const double inverse = 1 / direction[k];
      double in = (wide.low[k] - origin[k]) * inverse;
      double out = (wide.high[k] - origin[k]) * inverse;
      if (in > out) std::swap(in, out);
      first = std::max(first, in);
      last = std::min(last, out);
    }
    return first <= last * (1 + 8 * kEpsilon) ? first * (1 - 8 * kEpsilon) : kEndless;
  }

  /// Returns the box around a part.
  Box3 around(double first, double last) const {
    const Vector3d a = origin + first * direction;
    const Vector3d b = origin + last * direction;
    const double size = std::max({origin.cwiseAbs().maxCoeff(), a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff()});
    return Box3{a.cwiseMin(b), a.cwiseMax(b)}.grown(16 * kEpsilon * size);
  }
};

void check(const Vector3d& origin, const Vector3d& direction, double t_max, const scene::Images& images) {
  if (!origin.allFinite() || !direction.allFinite()) kernel::refuse("Scene::ray_cast: a number is not finite");
  if (!(direction.cwiseAbs().maxCoeff() > 0)) kernel::refuse("Scene::ray_cast: the direction is zero");
  if (!(t_max >= 0)) {
    kernel::refuse("Scene::ray_cast: t_max is " + std::to_string(t_max) + "; accepted: 0 or more");
  }
  constexpr double kMostCells = 1e9;
  if (images.periodic() && !(t_max * direction.stableNorm() <= kMostCells * images.shortest())) {
    kernel::refuse("Scene::ray_cast: t_max is " + std::to_string(t_max) +
                   "; accepted in a periodic scene: no more than 1e9 lattice vectors");
  }
}

}  // namespace

SceneRayHit Scene::ray_cast(const Vector3d& origin, const Vector3d& direction, double t_max) const {
  const scene::Images& images = bodies_->images;
  const scene::BroadPhase& broad = bodies_->broad;
  check(origin, direction, t_max, images);
  const Ray ray{origin, direction};
  Best<RayHit> best(t_max);
  // Periodic scenes: part after part, each about as long as a cell.
  const double part = images.periodic() ? images.shortest() / direction.stableNorm() : kEndless;
  const Box3 bounds = broad.bounds();
  for (double first = 0; first <= best.limit() && !bounds.empty(); first += part) {
    const double last = std::min(t_max, first + part);
    const auto visit_image = [&](const Vector3d& first_cell) {
      const Vector3d by = images.vector(first_cell);
      const auto bound = [&](const Box3& box) { return ray.enters(box.moved(by), first, last); };
      broad.in_order(std::min(last, best.limit()), bound, [&](std::int32_t item) {
        const double enters = bound(broad.tight(item));
        if (!(enters <= std::min(last, best.limit())) || std::isinf(enters)) return std::min(last, best.limit());
        const Body& body = bodies_->at(item);
        const Vector3d cell = first_cell - body.cell;
        const Pose there = scene::moved(body.X_WB, images.vector(cell));
        const RayHit hit =
            std::visit([&](const auto& shape) { return geom::ray_cast(shape, there, origin, direction); }, body.shape);
        if (hit.status == RayStatus::not_converged) {
          best.decline(body.id, cell, enters, hit);
        } else if (hit.status != RayStatus::missed) {
          best.add(body.id, cell, hit.t, hit);
        }
        return std::min(last, best.limit());
      });
      return true;
    };
    if (images.periodic()) {
      images.for_each_near(bounds, ray.around(first, last), 0, visit_image);
    } else {
      visit_image(Vector3d::Zero());
      break;
    }
  }
  SceneRayHit answer{best.image(images), {}};
  if (answer.body) {
    answer.hit = best.answer()->result;
  } else {
    answer.hit.status = RayStatus::missed;
  }
  return answer;
}

}  // namespace geom
