#include "scene/best.h"
#include "scene/bodies.h"

#include <geom/kernel/refuse.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
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

/// Interval of a ray's parameter.
struct Part {
  double first, last;
};

/// Ray origin + s direction, whose direction is scaled by a power of 2 to a length of about 1: t = s / 2^exponent.
class ScaledRay {
 public:
  ScaledRay(const Vector3d& origin, const Vector3d& direction) : origin_(origin) {
    std::frexp(direction.cwiseAbs().maxCoeff(), &exponent_);
    for (int k = 0; k < 3; ++k) direction_[k] = std::ldexp(direction[k], -exponent_);
  }

  const Vector3d& origin() const { return origin_; }
  const Vector3d& direction() const { return direction_; }
  double scaled(double t) const { return std::ldexp(t, exponent_); }     ///< s of a t
  double unscaled(double s) const { return std::ldexp(s, -exponent_); }  ///< t of an s

  /// Returns a lower bound of the s in a part at which the ray is in a box; infinite if it never is.
  double enters(const Box3& box, const Part& part) const {
    // Rounding moves the ray by less than this, seen from the box.
    const double size =
        std::max({origin_.cwiseAbs().maxCoeff(), box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff()});
    const Box3 wide = box.grown(16 * kEpsilon * size);
    double first = part.first, last = part.last;
    for (int k = 0; k < 3; ++k) {
      if (direction_[k] == 0) {
        if (origin_[k] < wide.low[k] || origin_[k] > wide.high[k]) return kEndless;
        continue;
      }
      // The inverse of a component may overflow.
      double in = (wide.low[k] - origin_[k]) / direction_[k];
      double out = (wide.high[k] - origin_[k]) / direction_[k];
      if (in > out) std::swap(in, out);
      first = std::max(first, in);
      last = std::min(last, out);
    }
    return first <= last * (1 + 8 * kEpsilon) ? first * (1 - 8 * kEpsilon) : kEndless;
  }

  /// Returns the box around a part.
  Box3 around(const Part& part) const {
    const Vector3d a = origin_ + part.first * direction_;
    const Vector3d b = origin_ + part.last * direction_;
    const double size = std::max({origin_.cwiseAbs().maxCoeff(), a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff()});
    return Box3{a.cwiseMin(b), a.cwiseMax(b)}.grown(16 * kEpsilon * size);
  }

 private:
  Vector3d origin_, direction_;
  int exponent_ = 0;
};

/// Clips a part to where the ray may be in images of a box: along directions in which the scene does not repeat all are
/// at the same heights. Empty, last < first, if it never is.
Part clipped(const ScaledRay& ray, const Box3& box, const scene::Images& images, Part part) {
  const Vector3d way = box.centre() - ray.origin(), widths = box.high - box.low;
  for (const Vector3d& open : images.open()) {
    const Vector3d n = open.dot(way) < 0 ? Vector3d(-open) : open;
    // |s v - h| <= w + tilt s, as heights are those along a direction that is tilted by the rounding of n.
    const double h = n.dot(way), v = n.dot(ray.direction()), tilt = 2 * scene::kOpenRounding;
    const double w = 0.5 * n.cwiseAbs().dot(widths) + scene::kOpenRounding * (way.norm() + widths.norm());
    const double quickest = v + tilt, slowest = v - tilt;
    if (quickest > 0) part.first = std::max(part.first, (h - w) / quickest);
    if (quickest < 0) part.last = std::min(part.last, (h - w) / quickest);
    if (quickest == 0 && h > w) part.last = -kEndless;
    if (slowest > 0) part.last = std::min(part.last, (h + w) / slowest);
  }
  return part;
}

/// Calls visit(part) for parts of a ray of a periodic scene, each about as long as the shortest lattice vector, in
/// order, until it returns false.
template <class Visit>
void in_parts(const ScaledRay& ray, const Part& all, const scene::Images& images, double t_max, const Visit& visit) {
  constexpr double kMostParts = 1e6;
  if (!(all.first <= all.last)) return;
  const double step = images.shortest() / ray.direction().norm();
  const double count = std::ceil((all.last - all.first) / step);
  if (!(count <= kMostParts)) {
    kernel::refuse("Scene::ray_cast: t_max is " + std::to_string(t_max) +
                   "; accepted in a periodic scene: no more than 1e6 times the shortest lattice vector, where bodies "
                   "may be");
  }
  const int parts = std::max(1, static_cast<int>(count));
  for (int k = 0; k < parts; ++k) {
    if (!visit({all.first + k * step, k + 1 < parts ? all.first + (k + 1) * step : all.last})) return;
  }
}

/// Calls visit(item, cell, s) of images of bodies that a part of the ray may meet, no earlier than at s, in that order
/// and until it is above best.limit(); image by image.
template <class Visit>
void visit_part(const ScaledRay& ray, const Part& part, const scene::BroadPhase& broad, const scene::Images& images,
                const Best<RayHit>& best, const Visit& visit) {
  const auto limit = [&] { return std::min(part.last, ray.scaled(best.limit())); };
  const auto visit_image = [&](const Vector3d& cell) {
    const Vector3d by = images.vector(cell);
    const auto bound = [&](const Box3& box) { return ray.enters(box.moved(by), part); };
    broad.in_order(limit(), bound, [&](std::int32_t item) {
      const double enters = bound(broad.tight(item));
      if (enters <= limit() && std::isfinite(enters)) visit(item, cell, enters);
      return limit();
    });
    return true;
  };
  if (images.periodic()) {
    images.for_each_near(broad.bounds(), ray.around(part), 0, visit_image);
  } else {
    visit_image(Vector3d::Zero());
  }
}

/// Refuses origins in a periodic scene that are so far away that rounding spreads a ray over many images.
void check_near(const Vector3d& origin, const scene::Images& images) {
  constexpr double kFurthest = 1e9;
  if (origin.cwiseAbs().maxCoeff() <= kFurthest * images.shortest()) return;
  kernel::refuse(
      "Scene::ray_cast: the origin is more than 1e9 times the shortest lattice vector away from that of the scene; "
      "accepted: nearer ones");
}

void check(const Vector3d& origin, const Vector3d& direction, double t_max) {
  if (!origin.allFinite() || !direction.allFinite()) kernel::refuse("Scene::ray_cast: a number is not finite");
  if (!(direction.cwiseAbs().maxCoeff() > 0)) kernel::refuse("Scene::ray_cast: the direction is zero");
  if (!(t_max >= 0)) {
    kernel::refuse("Scene::ray_cast: t_max is " + std::to_string(t_max) + "; accepted: 0 or more");
  }
}

}  // namespace

SceneRayHit Scene::ray_cast(const Vector3d& origin, const Vector3d& direction, double t_max) const {
  check(origin, direction, t_max);
  const scene::Images& images = bodies_->images;
  const scene::BroadPhase& broad = bodies_->broad;
  const ScaledRay ray(origin, direction);
  Best<RayHit> best(t_max);
  const auto visit = [&](std::int32_t item, const Vector3d& first_cell, double enters) {
    const Body& body = bodies_->at(item);
    const Vector3d cell = first_cell - body.cell;
    const Pose there = kernel::moved(body.X_WB, images.vector(cell));
    const RayHit hit =
        std::visit([&](const auto& shape) { return geom::ray_cast(shape, there, origin, direction); }, body.shape);
    if (hit.status == RayStatus::not_converged) {
      best.decline(body.id, cell, ray.unscaled(enters), hit);
    } else if (hit.status != RayStatus::missed) {
      best.add(body.id, cell, hit.t, hit);
    }
  };
  const Part all{0, ray.scaled(t_max)};
  const Box3 bounds = broad.bounds();
  if (!images.periodic()) {
    visit_part(ray, all, broad, images, best, visit);
  } else if (!bounds.empty()) {
    check_near(origin, images);
    double visited = 0;
    in_parts(ray, clipped(ray, bounds, images, all), images, t_max, [&](const Part& part) {
      if (!(part.first <= ray.scaled(best.limit()))) return false;
      // Vectors that are short beside bodies have many images on the way.
      scene::Images::check_count(visited += images.count_near(bounds, ray.around(part), 0));
      visit_part(ray, part, broad, images, best, visit);
      return true;
    });
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
