#include "scene/best.h"
#include "scene/bodies.h"

#include <geom/kernel/refuse.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

namespace geom {

using Eigen::Vector3d;
using scene::AnyBody;
using scene::Best;
using scene::Body;
using scene::Box3;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void check_within(double within) {
  if (!(within >= 0)) {
    kernel::refuse("Scene: within is " + std::to_string(within) + "; accepted: a length, 0 or more, or infinity");
  }
}

/// Returns options for a query of the nearest of many bodies: boxes bound the depth of Penetration::global alone.
DistanceOptions as_global(DistanceOptions options) {
  options.start.setZero();
  options.penetration = Penetration::global;
  return options;
}

/// Calls visit(item, cell) of images of bodies in the order of their boxes' bound(box), a lower bound of their value,
/// until it is above best.limit(); image by image.
template <class Bound, class Result, class Visit>
void visit_in_order(const scene::BroadPhase& broad, const scene::Images& images, const Box3& around, double reach,
                    const Bound& bound, const Best<Result>& best, const Visit& visit) {
  const Box3 bounds = broad.bounds();
  images.for_each_near(bounds, around, reach, [&](const Vector3d& cell) {
    const Vector3d by = images.vector(cell);
    if (!(bound(bounds.moved(by)) <= best.limit())) return true;
    broad.in_order(
        best.limit(), [&](const Box3& box) { return bound(box.moved(by)); },
        [&](std::int32_t item) {
          visit(item, cell);
          return best.limit();
        });
    return true;
  });
}

/// Calls visit(cell) for the images of a box that are no further from `around` than limit(), which visits lower, and
/// for some more: in shells that grow, up to where the box certainly has an image.
template <class Limit, class Visit>
void visit_images(const scene::Images& images, const Box3& box, const Box3& around, const Vector3d& here,
                  const Limit& limit, const Visit& visit) {
  // No two points of both are further apart than opposite corners.
  const Box3 near = box.moved(images.vector(here));
  const double furthest = (near.high - around.low).cwiseMax(around.high - near.low).norm();
  const auto most = [&] { return std::max(0.0, std::min(limit(), furthest)); };
  const double gap = images.open_gap(box, around);
  double reach = 0, along = images.shortest();
  do {
    reach = std::min(most(), std::hypot(gap, along));
    images.for_each_near(box, around, reach, visit);
    along *= 2;
  } while (reach < most());
}

/// Does what visit_in_order does, body by body: for bodies that are far from each other across the lattice, so that the
/// box around all of them has too many images.
template <class Bound, class Result, class Visit>
void visit_by_body(const scene::BroadPhase& broad, const scene::Images& images, const Box3& around, const Bound& bound,
                   const Best<Result>& best, const Visit& visit) {
  const Vector3d here = images.cell(around.centre(), "Scene");
  // Without a gap bodies may overlap by any depth.
  const auto least = [&](const Box3& box) {
    const double gap = images.open_gap(box, around);
    return gap > 0 ? gap : std::numeric_limits<double>::lowest();
  };
  broad.in_order(best.limit(), least, [&](std::int32_t item) {
    const Box3& box = broad.tight(item);
    const auto visit_cell = [&](const Vector3d& cell) {
      if (bound(box.moved(images.vector(cell))) <= best.limit()) visit(item, cell);
      return true;
    };
    visit_cell(here);
    visit_images(
        images, box, around, here, [&] { return best.limit(); }, visit_cell);
    return best.limit();
  });
}

/// Searches for the least of values that are not below the signed distance of boxes from `around`. Periodic scenes: in
/// shells that grow, up to where every body has an image.
template <class Result, class Visit>
void search(const scene::BroadPhase& broad, const scene::Images& images, const Box3& around, double within,
            Best<Result>& best, const Visit& visit) {
  const auto bound = [&](const Box3& box) { return scene::signed_distance(box, around); };
  const Box3 bounds = broad.bounds();
  if (bounds.empty()) return;
  double reach = within;
  double gap = 0, along = 0;
  if (images.periodic()) {
    gap = images.open_gap(bounds, around);
    along = images.shortest();
    const Vector3d here = images.vector(images.cell(around.centre(), "Scene"));
    const double widths = (bounds.high - bounds.low).norm() + (around.high - around.low).norm();
    within = std::min(within, std::max(0.0, bound(bounds.moved(here))) + widths + 3 * images.longest());
    reach = std::min(within, std::hypot(gap, along));
  }
  constexpr double kManyImages = 1e4;
  for (;;) {
    if (images.periodic() && images.count_near(bounds, around, reach) > kManyImages) {
      return visit_by_body(broad, images, around, bound, best, visit);
    }
    visit_in_order(broad, images, around, reach, bound, best, visit);
    if (reach >= within || best.limit() <= reach) return;
    along *= 2;
    reach = std::min(within, std::hypot(gap, along));
  }
}

}  // namespace

SceneNearest Scene::Bodies::nearest(const AnyBody& shape, const Pose& X_WS, const Body* self, double within,
                                    const DistanceOptions& distance_options) const {
  check_within(within);
  const Box3 around = scene::box_around(shape, X_WS, images.longest());
  const DistanceOptions global = as_global(distance_options);
  Best<DistanceResult> best(within);
  search(broad, images, around, within, best, [&](std::int32_t item, const Vector3d& first_cell) {
    const Body& body = at(item);
    if (self != nullptr && (body.id == self->id || !meet(body.filter, self->filter))) return;
    const Vector3d cell = first_cell - body.cell;
    const Pose there = kernel::moved(body.X_WB, images.vector(cell));
    const double bound = scene::lower_bound(shape, X_WS, body.shape, there);
    if (bound > best.limit()) return;
    const DistanceResult result = scene::distance(shape, X_WS, body.shape, there, global);
    if (std::isnan(result.distance)) {
      const double of_boxes = scene::signed_distance(broad.tight(item).moved(images.vector(first_cell)), around);
      best.decline(body.id, cell, std::isnan(bound) ? of_boxes : std::max(bound, of_boxes), result);
    } else {
      best.add(body.id, cell, result.distance, result);
    }
  });
  SceneNearest nearest{best.image(images), {}};
  if (nearest.body) nearest.result = best.answer()->result;
  return nearest;
}

SceneNearest Scene::nearest(const SceneShape& shape, const Pose& X_WS, double within,
                            const DistanceOptions& options) const {
  return bodies_->nearest(shape.any(), X_WS, nullptr, within, options);
}

SceneNearest Scene::nearest(BodyId body, double within, const DistanceOptions& options) const {
  const Body& self = bodies_->at(bodies_->item(body));
  return bodies_->nearest(self.shape, self.X_WB, &self, within, options);
}

ScenePair Scene::distance(BodyId i, BodyId j, const DistanceOptions& options) const {
  const Body& a = bodies_->at(bodies_->item(i));
  const std::int32_t item = bodies_->item(j);
  const Body& b = bodies_->at(item);
  if (i == j)
    kernel::refuse("Scene::distance: both handles are " + std::to_string(static_cast<std::uint32_t>(i)) +
                   "; accepted: two different bodies");
  const scene::Images& images = bodies_->images;
  const Box3 around = scene::box_around(a.shape, a.X_WB, images.longest());
  const Box3& box = bodies_->broad.tight(item);
  const DistanceOptions global = as_global(options);
  Best<DistanceResult> best(kInfinity);
  const auto visit = [&](const Vector3d& first_cell) {
    const Vector3d cell = first_cell - b.cell;
    const double bound = scene::signed_distance(box.moved(images.vector(first_cell)), around);
    if (bound > best.limit()) return true;
    const Pose there = kernel::moved(b.X_WB, images.vector(cell));
    const DistanceResult result = scene::distance(a.shape, a.X_WB, b.shape, there, global);
    if (std::isnan(result.distance)) {
      best.decline(j, cell, bound, result);
    } else {
      best.add(j, cell, result.distance, result);
    }
    return true;
  };
  visit(a.cell);
  if (images.periodic()) {
    // Vectors of a sheared lattice may bring an image nearer than that in the same cell.
    visit_images(
        images, box, around, a.cell, [&] { return best.limit(); }, visit);
  }
  return {i, j, images.vector(best.answer()->cell), best.answer()->result};
}

void Scene::Bodies::overlapping(const AnyBody& shape, const Pose& X_WS, std::vector<SceneImage>& out) const {
  images.cell(X_WS.position(), "Scene::overlapping");
  const Box3 around = scene::box_around(shape, X_WS, images.longest());
  std::vector<std::pair<BodyId, Vector3d>> found;
  for_each_near(around, 0, [&](std::int32_t item, const Vector3d& cell) {
    const Body& body = at(item);
    const Pose there = kernel::moved(body.X_WB, images.vector(cell));
    if (scene::overlap(shape, X_WS, body.shape, there) != Answer::no) found.emplace_back(body.id, cell);
  });
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : scene::cell_before(a.second, b.second);
  });
  out.clear();
  for (const auto& [body, cell] : found) out.push_back({body, images.vector(cell)});
}

void Scene::overlapping(const SceneShape& shape, const Pose& X_WS, std::vector<SceneImage>& out) const {
  bodies_->overlapping(shape.any(), X_WS, out);
}

ScenePoint Scene::closest_point(const Vector3d& p_W, double within) const {
  check_within(within);
  if (!p_W.allFinite()) kernel::refuse("Scene::closest_point: the point is not finite");
  const scene::Images& images = bodies_->images;
  Best<ClosestPoint> best(within);
  search(bodies_->broad, images, {p_W, p_W}, within, best, [&](std::int32_t item, const Vector3d& first_cell) {
    const Body& body = bodies_->at(item);
    const Vector3d cell = first_cell - body.cell;
    const Pose there = kernel::moved(body.X_WB, images.vector(cell));
    const ClosestPoint closest =
        std::visit([&](const auto& shape) { return geom::closest_point(shape, there, p_W); }, body.shape);
    if (std::isnan(closest.distance)) {
      const Box3 box = bodies_->broad.tight(item).moved(images.vector(first_cell));
      best.decline(body.id, cell, scene::signed_distance(box, {p_W, p_W}), closest);
    } else {
      best.add(body.id, cell, closest.distance, closest);
    }
  });
  ScenePoint point{best.image(images), {}};
  if (point.body) point.closest = best.answer()->result;
  return point;
}

}  // namespace geom
