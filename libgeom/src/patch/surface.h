#pragma once

#include <geom/contact_patch.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace geom::patch {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Returns the component of the cross product across the plane.
inline double cross(const Vector2d& u, const Vector2d& v) {
  return u.x() * v.y() - u.y() * v.x();
}

/// Returns the point of the segment from a to b that is closest to x.
inline Vector2d closest_on(const Vector2d& a, const Vector2d& b, const Vector2d& x) {
  const Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  if (length2 == 0) return a;
  return a + std::clamp(along.dot(x - a) / length2, 0.0, 1.0) * along;
}

/// Place of the plane across the normal, and axes: x and y in the plane, z along the normal from A to B.
struct Frame {
  Eigen::Matrix3d axes;  ///< columns, world frame
  Vector3d origin;       ///< world frame

  Vector3d to_world(const Vector3d& x) const { return origin + axes * x; }
  Vector3d from_world(const Vector3d& x) const { return axes.transpose() * (x - origin); }
};

/// Line {x : normal.x = reach} that bounds a convex set of the plane, which is below it, and what it belongs to.
struct Line {
  Vector2d normal = Vector2d::Zero();  ///< unit vector, outwards
  double reach = 0;
  std::uint32_t feature = 0;
  bool exact = false;  ///< whether it is a side of the set, not just a tangent
};

/// Plane above a surface that touches it: height(x) = height + slope.(x - x_0).
struct Tangent {
  double height = 0;
  Vector2d slope = Vector2d::Zero();
  std::uint32_t feature = 0;
};

/// Upper surface of a body, seen along a direction: a concave function on the body's shadow. For A that is along the
/// normal; for B, whose lower surface faces A, heights are along minus the normal.
class Surface {
 public:
  /// `sign`: 1 for A, -1 for B. `tolerance`: distance (length) that is rounding. Throws std::invalid_argument for a
  /// half-space whose plane is along the direction.
  Surface(const kernel::PatchBody& body, const Frame& frame, double sign, double tolerance);

  /// Returns whether tangents and lines are sides of the surface, of which there are finitely many.
  bool exact() const { return plane_.has_value() || !facets_.empty(); }
  /// Returns the number of faces and sides of a polytope; 0 of other bodies.
  std::size_t features() const { return facets_.size() + outline_.size(); }

  /// Returns whether the shadow has an end.
  bool bounded() const { return !plane_.has_value(); }

  /// Returns how far the shadow reaches along a unit vector.
  double reach(const Vector2d& direction) const;

  /// Returns a line that x is beyond by more than the tolerance; nullopt: x is in the shadow.
  std::optional<Line> beyond(const Vector2d& x) const;

  /// Returns the tangent plane over a place of the shadow; nullopt where a ray found none, and outside of the shadow
  /// of a curved surface. The feature is 0 for the face that lies most across the direction.
  std::optional<Tangent> at(const Vector2d& x) const;

  /// Returns the tangent plane over a place of a polytope without its walls, steep faces that bound the others; nullopt
  /// if all are walls.
  std::optional<Tangent> top(const Vector2d& x) const;

  /// Returns the line beyond which a place of a polytope is furthest, of the shadow's sides and of the rims along which
  /// walls bound the other faces; nullopt: x is beyond none by more than the tolerance.
  std::optional<Line> past_rim(const Vector2d& x) const;

  /// Returns the name of a polytope's side that is within `slack` of both ends of another side; nullopt: none.
  std::optional<std::uint32_t> side_along(const Vector2d& from, const Vector2d& to, double slack) const;

  /// Returns the tangent plane over a place; nullopt outside of the shadow, too.
  std::optional<Tangent> over(const Vector2d& x) const { return exact() && beyond(x) ? std::nullopt : at(x); }

 private:
  /// Face whose normal has a component along the direction.
  struct Facet {
    Vector2d slope;
    double height;  ///< height over the origin
    std::uint32_t feature;
    bool is_wall;
  };

  void read_hull(const kernel::Hull& hull);
  void read_box(const Vector3d& half);
  /// Makes facets and the outline of the shadow from corners and faces, body frame.
  void read_polytope(std::vector<Vector3d> corners, std::vector<Vector3d> normals, std::vector<double> offsets,
                     const std::vector<std::vector<int>>& faces);
  /// Makes the outline; axes of the frame, z along the direction.
  void read_outline(const std::vector<Vector3d>& corners, const std::vector<Vector3d>& normals,
                    const std::vector<std::vector<int>>& faces);
  /// Returns the lowest plane over a place among the walls, the other faces, or both, within the polytope's heights.
  std::optional<Tangent> lowest(const Vector2d& x, bool with_tops, bool with_walls) const;
  Vector3d local(const Vector3d& world_vector) const;
  Vector2d support(const Vector2d& direction) const;
  std::optional<Line> beyond_smooth(const Vector2d& x) const;

  const kernel::PatchBody& body_;
  const Frame& frame_;
  double sign_;
  double tolerance_;
  double top_ = 0;     ///< greatest height
  double bottom_ = 0;  ///< least height
  Vector2d middle_ = Vector2d::Zero();
  std::optional<Tangent> plane_;  ///< plane of a half-space, over the origin
  std::vector<Facet> facets_;     ///< upper faces of a polytope
  std::vector<Line> outline_;     ///< sides of a polytope's shadow
};

}  // namespace geom::patch
