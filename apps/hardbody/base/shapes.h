#pragma once

/// Kinds of shapes that configs and files name, and the numbers that define one of each. The sources of this pair are
/// the only place of the program that tells kinds apart by their type.

#include <ed/shape.h>

#include <geom/any_shape.h>
#include <geom/pose.h>

#include <Eigen/Core>

#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace hardbody {

/// Kind of shape; GSD files of this program store the values.
enum class ShapeKind {
  ellipsoid = 0,
  superellipsoid = 1,
  sphere = 2,
  capsule = 3,
  box = 4,
  polyhedron = 5,
  cylinder = 6,
  cone = 7
};

inline constexpr std::array kShapeKinds = {
    ShapeKind::ellipsoid, ShapeKind::superellipsoid, ShapeKind::sphere,   ShapeKind::capsule,
    ShapeKind::box,       ShapeKind::polyhedron,     ShapeKind::cylinder, ShapeKind::cone};

/// Returns the word that configs and files have for a kind.
const char* to_string(ShapeKind kind);

/// Returns the kind of this name; nullopt if there is none.
std::optional<ShapeKind> find_shape_kind(std::string_view name);

/// Returns the kind in the plural, as texts have it: "boxes".
const char* plural(ShapeKind kind);

/// Returns whether shapes of a kind are defined by semi-axes.
bool has_semi_axes(ShapeKind kind);

/// Returns whether shapes of a kind are defined by exponents, too.
bool has_exponents(ShapeKind kind);

/// Returns whether semi-axes (a, b, c) and (b, c, a) are one body of a kind, rotated.
bool has_equivalent_axes(ShapeKind kind);

/// Numbers that define a shape in files, to the last bit.
struct ShapeNumbers {
  ShapeKind kind = ShapeKind::ellipsoid;
  /// Semi-axes; half extents of a box; of a sphere its radius three times; of a capsule or cylinder radius, radius,
  /// half-length; of a cone radius, depth of the base below the origin, height.
  Eigen::Vector3d lengths{1, 1, 1};
  Eigen::Vector2d exponents{1, 1};             ///< e1, e2; 1, 1 for kinds without exponents
  double rounding = 0;                         ///< radius of a ball that is swept over the shape
  std::vector<Eigen::Vector3d> vertices = {};  ///< vertices of a polyhedron
};

/// Returns the numbers of a shape. Throws std::logic_error for a user's shape, which no config or file can name.
ShapeNumbers numbers_of(const ed::BodyShape& shape);

/// Returns the shape of these numbers. Throws std::invalid_argument if libgeom refuses them.
geom::Shape make_shape(const ShapeNumbers& numbers);
/// Returns the same shape for a body in motion. Throws std::invalid_argument if libgeom refuses the numbers.
ed::BodyShape make_body_shape(const ShapeNumbers& numbers);

/// Returns the same shape for a body in motion.
ed::BodyShape body_shape(const geom::Shape& shape);
/// Returns the shape of a body in motion. Throws std::logic_error for a user's shape.
geom::Shape geom_shape(const ed::BodyShape& shape);

/// Polyhedron in a frame that a body may have.
struct FramedPolyhedron {
  geom::Shape shape;
  std::optional<geom::Pose> X_PB = std::nullopt;  ///< pose of the frame in that of the points, if it is another one
};

/// Returns the hull of points, with a ball swept over it, in the frame of its principal axes; in the points' own, to
/// the bit, where that is one within `apart`, relative to the size. Throws std::invalid_argument if libgeom refuses it.
FramedPolyhedron framed_polyhedron(const std::vector<Eigen::Vector3d>& points, double rounding, double apart);

/// Number of vertices on a rim where a cylinder or cone is drawn as a polytope.
inline constexpr int kRimVertices = 48;

/// Polytope with a ball swept over it.
struct SweptPolytope {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::vector<int>> faces;  ///< vertices of each face, anticlockwise; none of a segment
  double rounding = 0;                  ///< radius of the ball
};

/// Returns a shape as a polytope with a ball, as which files and pictures have capsules (two vertices), boxes and
/// polyhedra, and nearly cylinders and cones (kRimVertices on each rim); nullopt for smooth shapes, spheres among them.
std::optional<SweptPolytope> swept_polytope(const ed::BodyShape& shape);

/// Returns whether two shapes are the same: numbers of one kind whose lengths agree within `lengths`, relative to those
/// of `b`, and whose exponents agree within `exponents`. A sphere is the ellipsoid with equal semi-axes, a box the
/// polyhedron of its corners, and a cylinder or cone that as which it is drawn.
bool same_shape(const ed::BodyShape& a, const ed::BodyShape& b, double lengths, double exponents);

}  // namespace hardbody
