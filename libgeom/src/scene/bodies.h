#pragma once

/// Bodies of a scene, and the pairs of them that may be near.

#include "scene/broad_phase.h"
#include "scene/images.h"

#include <geom/scene.h>

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

namespace geom::scene {

/// Shape of a body, or of a query.
using AnyBody = std::variant<Shape, AnyConvex>;

struct Body {
  AnyBody shape;
  Pose X_WB;
  Filter filter;
  BodyId id{};
  Eigen::Vector3d cell = Eigen::Vector3d::Zero();   ///< lattice numbers; less these the body is in the first cell
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< minus that lattice vector
};

/// Pose of a body, and what follows from it.
struct Placement {
  Pose X_WB;
  Eigen::Vector3d cell, shift;  ///< members of Body
  Box3 box;                     ///< box around the body, moved by `shift`
};

/// Two bodies, i < j, and the lattice numbers of the image of j.
struct Candidate {
  std::int32_t i, j;
  Eigen::Vector3d cell;
};

/// Returns a box around a shape, rounding included.
Box3 box_around(const AnyBody& shape, const Pose& X_WB, double cell_size);

/// Functions of the shapes inside; those of two kinds go by AnyConvex.
/// @{
DistanceResult distance(const AnyBody& a, const Pose& X_WA, const AnyBody& b, const Pose& X_WB,
                        const DistanceOptions& options);
double lower_bound(const AnyBody& a, const Pose& X_WA, const AnyBody& b, const Pose& X_WB);
Answer overlap(const AnyBody& a, const Pose& X_WA, const AnyBody& b, const Pose& X_WB);
/// @}

/// Returns whether lattice numbers a come before b, in the order of answers.
inline bool cell_before(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  for (int k = 0; k < 3; ++k) {
    if (a[k] != b[k]) return a[k] < b[k];
  }
  return false;
}

}  // namespace geom::scene

namespace geom {

struct Scene::Bodies {
  explicit Bodies(const SceneOptions& given);

  /// Returns the item of a body. Throws std::invalid_argument if there is none.
  std::int32_t item(BodyId body) const;
  const scene::Body& at(std::int32_t item) const { return *all[static_cast<std::size_t>(item)]; }
  scene::Body& at(std::int32_t item) { return *all[static_cast<std::size_t>(item)]; }

  BodyId add(scene::AnyBody shape, const Pose& X_WB, Filter filter);
  void remove(BodyId body);
  /// Returns where a body of this shape is at a pose. Throws std::invalid_argument, naming `what`, for one that is too
  /// far away, and what the shape's functions throw.
  scene::Placement placement(const scene::AnyBody& shape, const Pose& X_WB, const char* what) const;
  void move(std::int32_t item, const scene::Placement& to) noexcept;

  /// Calls visit(i, j, cell) for pairs, i < j by handle, whose boxes are within the cut-off. `visit` returns false to
  /// stop.
  template <class Visit>
  bool for_each_pair(double cutoff, const Visit& visit) const;

  /// Returns those pairs in the order of answers.
  std::vector<scene::Candidate> candidates(double cutoff) const;

  /// Calls visit(item, cell) for bodies, images included, whose boxes are within `reach` of a box.
  template <class Visit>
  void for_each_near(const scene::Box3& box, double reach, const Visit& visit) const;

  /// Functions of the same name of Scene. `self`: body whose filter counts, and that is left out; null: none.
  /// @{
  SceneNearest nearest(const scene::AnyBody& shape, const Pose& X_WS, const scene::Body* self, double within,
                       const DistanceOptions& distance_options) const;
  void overlapping(const scene::AnyBody& shape, const Pose& X_WS, std::vector<SceneImage>& out) const;
  /// @}

  SceneOptions options;
  scene::Images images;
  scene::BroadPhase broad;
  std::vector<std::optional<scene::Body>> all;  ///< bodies by item
  std::vector<std::int32_t> item_of;            ///< items by handle; -1: removed
  std::size_t count = 0;
};

template <class Visit>
bool Scene::Bodies::for_each_pair(double cutoff, const Visit& visit) const {
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  // Both bodies as they are in the first cell, the second one moved by a lattice vector.
  const auto emit = [&](std::int32_t a, std::int32_t b, const Eigen::Vector3d& by, const Eigen::Vector3d& cell) {
    const scene::Body& s = at(a);
    const scene::Body& t = at(b);
    if (a == b || !meet(s.filter, t.filter)) return true;
    if (!(scene::signed_distance(broad.tight(a), broad.tight(b).moved(by)) <= cutoff)) return true;
    const Eigen::Vector3d of_b = cell + s.cell - t.cell;
    return s.id < t.id ? visit(a, b, of_b) : visit(b, a, Eigen::Vector3d(none - of_b));  // without -0
  };
  if (!broad.for_each_pair(cutoff, nullptr, [&](std::int32_t a, std::int32_t b) { return emit(a, b, none, none); })) {
    return false;
  }
  if (!images.periodic()) return true;
  const scene::Box3 bounds = broad.bounds();
  return images.for_each_near(bounds, bounds, cutoff, [&](const Eigen::Vector3d& cell) {
    // Of two opposite lattice vectors one has all pairs.
    if (!scene::cell_before(none, cell)) return true;
    const Eigen::Vector3d by = images.vector(cell);
    return broad.for_each_pair(cutoff, &by, [&](std::int32_t a, std::int32_t b) { return emit(a, b, by, cell); });
  });
}

template <class Visit>
void Scene::Bodies::for_each_near(const scene::Box3& box, double reach, const Visit& visit) const {
  images.for_each_near(broad.bounds(), box, reach, [&](const Eigen::Vector3d& cell) {
    const scene::Box3 back = box.moved(-images.vector(cell));
    broad.for_each([&](const scene::Box3& other) { return scene::signed_distance(other, back) <= reach; },
                   [&](std::int32_t item) {
                     if (scene::signed_distance(broad.tight(item), back) <= reach) visit(item, cell - at(item).cell);
                     return true;
                   });
    return true;
  });
}

}  // namespace geom
