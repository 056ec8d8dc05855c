#pragma once

/// @file
/// Contact patches: all points at which the surfaces of two bodies are within a given distance of touching.

#include <geom/any_convex.h>
#include <geom/any_shape.h>
#include <geom/distance.h>
#include <geom/export.h>
#include <geom/half_space.h>
#include <geom/kernel/core.h>
#include <geom/pose.h>
#include <geom/queries.h>
#include <geom/shape.h>
#include <geom/shape_variant.h>

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

namespace geom {

/// Options of contact_patch.
struct PatchOptions {
  /// Greatest gap (length) of the surfaces along the normal at which they count as touching, 0 to 1e100.
  double within = 0;
  /// Accuracy of the outlines of curved surfaces, of the patch's diameter, within [1e-4, 0.5].
  double tolerance = 0.01;
  /// Largest number of points, >= 3. Of more corners those are left out whose triangles are smallest; corners within
  /// 1e-6 of the extent of both shadows' common part of each other are one.
  int max_points = 8;
};

/// Dimension of a contact patch.
enum class PatchKind {
  /// The surfaces are further apart than `within` everywhere, or there is no distance. Along another normal than that
  /// of
  /// the distance also: no ray met a curved surface.
  empty,
  point,    ///< a single point
  segment,  ///< a line between two points
  polygon,  ///< an area, its corners anticlockwise about the normal
};

/// Returns the enumerator's name.
GEOM_EXPORT const char* to_string(PatchKind kind);

/// Corner of a contact patch: the two points of the surfaces that are on one line along the normal, world frame.
///
/// Faces of polytopes steeper than 10, the walls of bodies that are tilted a little, bound the patch where the gap is
/// `within`. Corners are moved off them, by at most 1e-6 of the extent of both shadows' common part, a tenth of the
/// patch's width if that is less: their depth is that of the faces that touch.
struct PatchPoint {
  Eigen::Vector3d point_a, point_b;
  double depth = 0;  ///< height of A's surface above that of B along the normal; negative where they are apart
  /// Identity of the corner: the two features of the bodies, faces mostly, that bound the patch there; of curved
  /// surfaces the corner's direction from the middle in A's frame, in 32 sectors. The same from call to call while
  /// bodies move a little, unless another face of a body becomes the flattest one; sides of B within 1e-6 of the extent
  /// from those of A count as A's. Corners of round outlines are found anew at each call, and mostly in other sectors.
  /// Different within a patch.
  std::uint64_t id = 0;
};

/// Contact patch of two bodies and a normal n, from A to B.
///
/// Let u be a point of the plane across n, h_A(u) the greatest height along n of A over u, and h_B(u) the least one of
/// B. The patch is the convex set of all u at which both bodies are and h_B(u) - h_A(u) <= within.
struct [[nodiscard]] ContactPatch {
  PatchKind kind = PatchKind::empty;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit vector from A to B
  double area = 0;                                   ///< area of the patch, along the normal; 0 unless a polygon
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< centroid, halfway between the surfaces
  double error = 0;  ///< bound of the distance of a corner from the patch (length), before corners are left out
  std::vector<PatchPoint> points;  ///< 0, 1, 2, or at least 3 for a polygon
};

namespace kernel {

/// Body as contact patches see it. Refers to the shape, which must outlive it.
struct PatchBody {
  Pose X_WS;
  std::optional<CoreView> core;      ///< core of a CoreShape
  const HalfSpace* plane = nullptr;  ///< half-space; the members below are then not used
  double bounding_radius = 0;        ///< radius of a sphere around the origin of X_WS
  const void* shape = nullptr;       ///< first argument of the two functions
  Support (*support)(const void*, const Eigen::Vector3d&) = nullptr;  ///< support function, body frame
  RayHit (*ray)(const void*, const Pose&, const Eigen::Vector3d&,
                const Eigen::Vector3d&) = nullptr;  ///< ray cast, world frame: pose, origin, direction
};

/// Returns whether the surface is that of a polytope.
inline bool is_polytope(const std::optional<CoreView>& core) {
  return core && core->radius == 0 && (core->kind == CoreKind::hull || core->kind == CoreKind::box);
}

/// Returns the view of a shape at X_WS.
/// @{
template <SupportShape S>
PatchBody patch_body(const S& shape, const Pose& X_WS) {
  PatchBody body;
  body.X_WS = X_WS;
  body.bounding_radius = shape.bounding_radius();
  body.shape = &shape;
  if constexpr (CoreShape<S>) body.core.emplace(shape.core());
  body.support = [](const void* s, const Eigen::Vector3d& n) { return Support(static_cast<const S*>(s)->support(n)); };
  body.ray = [](const void* s, const Pose& X, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
    return ray_cast(*static_cast<const S*>(s), X, origin, direction);
  };
  return body;
}
/// Overload; a polytope inside is exact, all others are seen through their type-erased functions.
inline PatchBody patch_body(const AnyConvex& shape, const Pose& X_WS) {
  const AnyConvex::Part& part = shape.part();
  const std::optional<CoreView> core = part.shape->core();
  if (part.skin != 0 || !is_polytope(core)) return patch_body<AnyConvex>(shape, X_WS);
  PatchBody body;
  body.X_WS = X_WS * part.X_BI;
  body.core.emplace(*core);
  body.bounding_radius = part.shape->bounding_radius();
  body.shape = part.shape.get();
  body.support = [](const void* s, const Eigen::Vector3d& n) {
    return static_cast<const AnyConvex::Concept*>(s)->support(n);
  };
  return body;
}
inline PatchBody patch_body(const HalfSpace& shape, const Pose& X_WS) {
  PatchBody body;
  body.X_WS = X_WS;
  body.plane = &shape;
  return body;
}
template <SupportShape Inner>
PatchBody patch_body(const Placed<Inner>& shape, const Pose& X_WS) {
  return patch_body(shape.inner(), X_WS * shape.pose());
}
template <class... Shapes>
PatchBody patch_body(const std::variant<Shapes...>& shape, const Pose& X_WS) {
  return std::visit([&](const auto& s) { return patch_body(s, X_WS); }, shape);
}
/// @}

/// Returns the patch of two bodies at an answer.
GEOM_EXPORT ContactPatch contact_patch(const PatchBody& a, const PatchBody& b, const DistanceResult& at,
                                       const PatchOptions& options);

}  // namespace kernel

/// Returns the contact patch of two bodies along the normal of `at`, an answer of `distance` for this pair. Another
/// normal may be put there; its length is 1. Bodies may be any SupportShape, geom::Shape, or one of them a HalfSpace.
///
/// Boxes, polyhedra and half-spaces, beside each other: exact, the outline to 1e-13 of the size, and 1e-13 of it
/// divided by the sine of the angle between two faces where they cut each other. All others: the polygon contains the
/// patch, and its corners are not further outside than `tolerance` times its diameter; `error` is a bound of the
/// distance itself. A face that is tilted by a small angle is the whole patch as soon as `within` spans it, so that
/// resting bodies do not rock.
///
/// Polygons narrower than 1e-9 of the extent of what both bodies' shadows have in common, for curved surfaces than
/// three times the tolerance of their length (0.1 at most), are segments; segments shorter than 1e-9 of it, 1e-6 for
/// curved ones, points. Empty if `at` has no answer. Throws std::invalid_argument if an option is out of range, the
/// normal of an answer is not of length 1, or that of a half-space points along its plane.
template <class A, class B>
ContactPatch contact_patch(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB, const DistanceResult& at,
                           const PatchOptions& options) {
  return kernel::contact_patch(kernel::patch_body(a, X_WA), kernel::patch_body(b, X_WB), at, options);
}

/// Overload that computes the distance first.
template <class A, class B>
ContactPatch contact_patch(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB, const PatchOptions& options) {
  const DistanceResult at = distance(a, X_WA, b, X_WB, {});
  return contact_patch(a, X_WA, b, X_WB, at, options);
}

}  // namespace geom
