#pragma once

/// Shapes that are a polytope or the hull of two discs, the core, with a ball swept over it: spheres, capsules, boxes,
/// polyhedra, cylinders, cones and rounded ones; and points that two bodies have in common, which prove an overlap.

#include <geom/export.h>
#include <geom/pose.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <array>
#include <concepts>
#include <vector>

namespace geom::kernel {

/// Kind of a core: a point, a segment along z, a box along the axes, the convex hull of points, or the convex hull of
/// two discs about z.
enum class CoreKind { point, segment, box, hull, frustum };

/// Disc about the z axis, one end of a frustum; radius 0: a point, the apex of a cone.
struct CoreDisc {
  double z = 0;
  double radius = 0;
};

/// Edge of a hull: its vertices, and the faces on both sides.
struct HullEdge {
  int from, to;
  int left, right;
};

/// Convex polyhedron with all faces, edges and vertices, none of them degenerate.
struct Hull {
  Eigen::Matrix<double, Eigen::Dynamic, 3> vertices;  ///< rows with the coordinates of one vertex each
  std::vector<Eigen::Vector3d> normals;               ///< unit outward normal of each face
  std::vector<double> offsets;          ///< distance of each face from the origin: its normal times the furthest vertex
  std::vector<std::vector<int>> faces;  ///< vertices of each face, anticlockwise seen from outside
  std::vector<HullEdge> edges;
};

/// Core of a shape, and the radius of the ball swept over it. Refers to the shape, which must outlive it.
struct CoreView {
  CoreKind kind = CoreKind::point;
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  ///< half extents along the body's axes; (0, 0, l) of a segment
  const Hull* hull = nullptr;                      ///< the polyhedron of CoreKind::hull, else null
  std::array<CoreDisc, 2> disc = {};               ///< lower and upper end of CoreKind::frustum, the lower no smaller
  double radius = 0;                               ///< radius of the swept ball
  double bounding_radius = 0;                      ///< distance of the furthest point of the core from the origin
};

/// Returns the vertex (row) of a hull that is furthest along n.
GEOM_EXPORT int support_vertex(const Hull& hull, const Eigen::Vector3d& n);

/// Returns the support of a core, without the ball.
GEOM_EXPORT Support core_support(const CoreView& core, const Eigen::Vector3d& n);

/// Returns the Hessian of the support function of a frustum: that of the rim that is furthest along n, zero along z.
GEOM_EXPORT Eigen::Matrix3d rim_hessian(const CoreView& core, const Eigen::Vector3d& n);

/// Returns the support of a core with its ball; n != 0.
inline Support swept_support(const CoreView& core, const Eigen::Vector3d& n) {
  Support s = core_support(core, n);
  if (core.radius == 0) return s;
  const double length = n.norm();
  s.height += core.radius * length;
  s.point += core.radius / length * n;
  return s;
}

/// Returns whether a point is in a frustum without a ball, or on its surface.
GEOM_EXPORT bool frustum_contains(const CoreView& core, const Eigen::Vector3d& x);

/// Integrals over a body of uniform density, about the origin.
struct SweptMass {
  double volume = 0;
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();   ///< integral of x
  Eigen::Matrix3d second_moment = Eigen::Matrix3d::Zero();  ///< integral of x x^T

  Eigen::Vector3d centre() const { return first_moment / volume; }
  /// Returns the inertia tensor about the origin.
  Eigen::Matrix3d inertia(double mass) const {
    return mass / volume * (second_moment.trace() * Eigen::Matrix3d::Identity() - second_moment);
  }
  /// Returns whether the origin is the centre of mass and the axes are the principal ones, to 1e-9 of a length.
  GEOM_EXPORT bool is_principal(double length) const;
};

/// Returns volume and moments of a core with its ball, in closed form.
GEOM_EXPORT SweptMass swept_mass(const CoreView& core);

/// Returns the radius of a rounding. Throws std::invalid_argument unless it is within [0, kMaxSemiAxis].
GEOM_EXPORT double checked_rounding(double radius);

/// Returns the Hessian of the support function of a ball; polytopes add none where they have one.
inline Eigen::Matrix3d ball_hessian(double radius, const Eigen::Vector3d& n) {
  const double length = n.norm();
  const Eigen::Vector3d unit = n / length;
  return radius / length * (Eigen::Matrix3d::Identity() - unit * unit.transpose());
}

}  // namespace geom::kernel

namespace geom {

/// SupportShape that is a polytope or the hull of two discs, with a ball swept over it, and says so. Pairs of them have
/// an exact `distance`.
template <class T>
concept CoreShape = SupportShape<T> && requires(const T& shape) {
  { shape.core() } -> std::same_as<kernel::CoreView>;
};

/// Shape that tells whether a point of its frame is in it or on its surface.
template <class T>
concept PointSet = requires(const T& shape, const Eigen::Vector3d& x) {
  { shape.contains(x) } -> std::same_as<bool>;
};

namespace kernel {

/// Returns whether holds(p) is true for a point p between the witness points of bodies that overlap.
///
/// Each body contains a part of the segment, which begins at its own witness point. Mostly each contains half of it; if
/// a small or thin body is inside a larger one, the larger contains nearly all.
template <class Holds>
bool holds_between(const Eigen::Vector3d& point_a, const Eigen::Vector3d& point_b, const Holds& holds) {
  // The ends are left out: rounding decides on which side of the surface they are.
  for (const double share : {0.5, 0.02, 0.98, 0.25, 0.75}) {
    if (holds(Eigen::Vector3d(point_a + share * (point_b - point_a)))) return true;
  }
  return false;
}

/// Returns whether a point (body frame) is in a body; false for shapes that cannot tell.
template <class Shape>
bool holds_point(const Shape& shape, const Eigen::Vector3d& p_B) {
  if constexpr (PointSet<Shape>) {
    return shape.contains(p_B);
  } else if constexpr (ImplicitSurface<Shape>) {
    return shape.value(p_B) <= 0;
  } else {
    return false;
  }
}

/// Returns whether a point (world frame) is in both bodies; false for shapes without an equation, for which it is
/// unknown.
template <class ShapeA, class ShapeB>
bool both_contain(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const Eigen::Vector3d& p_W) {
  return holds_point(a, X_WA.to_body(p_W)) && holds_point(b, X_WB.to_body(p_W));
}

/// Returns whether both bodies contain the point between their centres that deeply overlapping bodies are likely to
/// share.
template <class ShapeA, class ShapeB>
bool share_the_middle(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB) {
  const double r_a = a.inscribed_radius();
  const double r_b = b.inscribed_radius();
  return both_contain(a, X_WA, b, X_WB, Eigen::Vector3d((r_b * X_WA.position() + r_a * X_WB.position()) / (r_a + r_b)));
}

/// Returns whether a point inside both bodies is found, between the witness points of an answer or between the centres.
/// True is certain, false is not.
template <class ShapeA, class ShapeB>
bool share_a_point(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const Eigen::Vector3d& point_a,
                   const Eigen::Vector3d& point_b) {
  const auto holds = [&](const Eigen::Vector3d& p_W) { return both_contain(a, X_WA, b, X_WB, p_W); };
  return holds_between(point_a, point_b, holds) || share_the_middle(a, X_WA, b, X_WB);
}

}  // namespace kernel
}  // namespace geom
