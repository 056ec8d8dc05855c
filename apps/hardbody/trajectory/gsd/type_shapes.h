#pragma once

#include <ed/shape.h>

#include <geom/pose.h>

#include <cstddef>
#include <optional>
#include <string>

namespace hardbody {

/// Returns a row of particles/type_shapes: {"type": "Ellipsoid", "a": .., "b": .., "c": ..}, semi-axes; for spheres
/// {"type": "Sphere", "diameter": ..}; for capsules, boxes and polyhedra {"type": "ConvexPolyhedron",
/// "rounding_radius": .., "vertices": [..]}, two vertices for a capsule; for cylinders and cones one with
/// kRimVertices on each rim; for superellipsoids one with vertices on the surface (fewer if there are many types); for
/// users' own shapes {}.
std::string type_shape_json(const std::optional<ed::BodyShape>& shape, std::size_t types);

/// Shape of a type.
struct TypeShape {
  ed::BodyShape shape;
  /// Frame of the shape, that of its principal axes, in the frame of the file's bodies; nullopt: the same.
  std::optional<geom::Pose> X_BS = std::nullopt;
};

/// Returns the shape of a row if it is an ellipsoid, a sphere or a convex polyhedron with or without a rounding;
/// nullopt for others. Throws InputError, without naming the place, for text that is not JSON, and for numbers that no
/// body can have.
std::optional<TypeShape> read_type_shape(const std::string& json);

/// Returns the shape of a row that this program has written for `known`, with the rounding of the text; nullopt if the
/// row does not tell the shape: that of a superellipsoid. Throws InputError as read_type_shape().
std::optional<ed::BodyShape> read_own_type_shape(const std::string& json, const ed::BodyShape& known);

}  // namespace hardbody
