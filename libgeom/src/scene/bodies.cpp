#include "scene/bodies.h"

#include <geom/kernel/any_body.h>
#include <geom/kernel/refuse.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <type_traits>

namespace geom {
namespace scene {

using Eigen::Vector3d;

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Returns how far the body extends along the axes of the world, of its origin.
template <class Body>
Box3 extents(const Body& body, const Pose& X_WB) {
  Box3 box;
  const Eigen::Matrix3d& R = X_WB.rotation();
  for (int k = 0; k < 3; ++k) {
    if constexpr (std::is_same_v<Body, Ellipsoid>) {
      box.high[k] = R.row(k).transpose().cwiseProduct(body.semi_axes()).norm();
      box.low[k] = -box.high[k];
    } else {
      const Vector3d n = R.row(k).transpose();
      box.high[k] = Support(body.support(n)).height;
      box.low[k] = -Support(body.support(-n)).height;
    }
  }
  return box;
}

/// Calls f of both shapes: as they are if both are of one kind, else as AnyConvex.
template <class F>
auto with_shapes(const AnyBody& a, const AnyBody& b, const F& f) {
  const Shape* s = std::get_if<Shape>(&a);
  const Shape* t = std::get_if<Shape>(&b);
  if (s != nullptr && t != nullptr) return f(*s, *t);
  if (s != nullptr) return f(AnyConvex(*s), std::get<AnyConvex>(b));
  if (t != nullptr) return f(std::get<AnyConvex>(a), AnyConvex(*t));
  return f(std::get<AnyConvex>(a), std::get<AnyConvex>(b));
}

}  // namespace

Box3 box_around(const AnyBody& shape, const Pose& X_WB, double cell_size) {
  const Box3 box = std::visit(
      [&](const auto& s) {
        if constexpr (std::is_same_v<std::decay_t<decltype(s)>, Shape>) {
          return kernel::with_body(s, [&](const auto& body) { return extents(body, X_WB); });
        } else {
          return extents(s, X_WB);
        }
      },
      shape);
  if (!box.high.allFinite() || !box.low.allFinite()) {
    kernel::refuse(
        "Scene: a support height of the shape is not finite; geom::check_support says what is wrong with it");
  }
  const double size = std::max(box.high.cwiseAbs().maxCoeff(), box.low.cwiseAbs().maxCoeff());
  // A ray meets a body within kRayGap of five radii.
  const double rounding =
      16 * kEpsilon * (X_WB.position().cwiseAbs().maxCoeff() + size + cell_size) + 10 * kRayGap * size;
  return box.moved(X_WB.position()).grown(rounding);
}

DistanceResult distance(const AnyBody& a, const Pose& X_WA, const AnyBody& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  return with_shapes(a, b, [&](const auto& s, const auto& t) { return geom::distance(s, X_WA, t, X_WB, options); });
}

double lower_bound(const AnyBody& a, const Pose& X_WA, const AnyBody& b, const Pose& X_WB) {
  const Vector3d n = X_WB.position() - X_WA.position();
  // Distances of bodies at large coordinates may be this much below the bound.
  const double size = std::max(X_WA.position().cwiseAbs().maxCoeff(), X_WB.position().cwiseAbs().maxCoeff());
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * size;
  return with_shapes(
      a, b, [&](const auto& s, const auto& t) { return distance_lower_bound(s, X_WA, t, X_WB, n) - rounding; });
}

Answer overlap(const AnyBody& a, const Pose& X_WA, const AnyBody& b, const Pose& X_WB) {
  return with_shapes(a, b, [&](const auto& s, const auto& t) { return geom::overlap(s, X_WA, t, X_WB); });
}

namespace {

double checked_margin(double margin) {
  if (!(margin >= 0) || !std::isfinite(margin)) {
    kernel::refuse("SceneOptions: margin is " + std::to_string(margin) + "; accepted: a finite length, 0 or more");
  }
  return margin;
}

}  // namespace
}  // namespace scene

using Eigen::Vector3d;
using scene::Body;

Scene::Bodies::Bodies(const SceneOptions& given)
    : options(given), images(given.lattice), broad(scene::checked_margin(given.margin)) {}

std::int32_t Scene::Bodies::item(BodyId body) const {
  const auto k = static_cast<std::size_t>(body);
  if (k >= item_of.size() || item_of[k] < 0) {
    kernel::refuse("Scene: body " + std::to_string(k) +
                   (k < item_of.size() ? " has been removed" : " has not been added") +
                   "; accepted: one of the scene's " + std::to_string(count) + " bodies");
  }
  return item_of[k];
}

scene::Placement Scene::Bodies::placement(const scene::AnyBody& shape, const Pose& X_WB, const char* what) const {
  const Vector3d cell = images.cell(X_WB.position(), what);
  const Vector3d shift = -images.vector(cell);
  const double cell_size = images.periodic() ? shift.cwiseAbs().maxCoeff() + images.longest() : 0;
  return {X_WB, cell, shift, scene::box_around(shape, X_WB, cell_size).moved(shift)};
}

BodyId Scene::Bodies::add(scene::AnyBody shape, const Pose& X_WB, Filter filter) {
  constexpr std::size_t kMost = std::size_t{1} << 31;
  if (item_of.size() + 1 >= kMost) kernel::refuse("Scene: more than 2^31 bodies were added");
  const scene::Placement at = placement(shape, X_WB, "Scene");
  const auto id = static_cast<BodyId>(item_of.size());
  // What may throw comes first. The lowest free item is at most `count`.
  if (all.size() <= count) all.resize(count + 1);
  scene::make_room(item_of, item_of.size() + 1);
  const std::int32_t item = broad.add(at.box);
  all[static_cast<std::size_t>(item)] = Body{std::move(shape), X_WB, filter, id, at.cell, at.shift};
  item_of.push_back(item);
  ++count;
  return id;
}

void Scene::Bodies::remove(BodyId body) {
  const std::int32_t k = item(body);
  broad.remove(k);
  all[static_cast<std::size_t>(k)].reset();
  item_of[static_cast<std::size_t>(body)] = -1;
  --count;
}

void Scene::Bodies::move(std::int32_t k, const scene::Placement& to) noexcept {
  Body& body = at(k);
  body.X_WB = to.X_WB;
  body.cell = to.cell;
  body.shift = to.shift;
  broad.move(k, to.box);
}

std::vector<scene::Candidate> Scene::Bodies::candidates(double cutoff) const {
  std::vector<scene::Candidate> found;
  for_each_pair(cutoff, [&](std::int32_t i, std::int32_t j, const Vector3d& cell) {
    found.push_back({i, j, cell});
    return true;
  });
  std::sort(found.begin(), found.end(), [&](const scene::Candidate& a, const scene::Candidate& b) {
    const auto key = [&](const scene::Candidate& c) { return std::pair(at(c.i).id, at(c.j).id); };
    if (key(a) != key(b)) return key(a) < key(b);
    return scene::cell_before(a.cell, b.cell);
  });
  return found;
}

}  // namespace geom
