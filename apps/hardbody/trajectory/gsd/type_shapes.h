#pragma once

#include <ed/shape.h>

#include <cstddef>
#include <optional>
#include <string>

namespace hardbody {

/// Returns a row of particles/type_shapes: {"type": "Ellipsoid", "a": .., "b": .., "c": ..}, semi-axes; for spheres
/// {"type": "Sphere", "diameter": ..}; for superellipsoids a "ConvexPolyhedron" with vertices on the surface (fewer if
/// there are many types); for users' own shapes {}.
std::string type_shape_json(const std::optional<ed::BodyShape>& shape, std::size_t types);

/// Returns the shape of a row if it is an ellipsoid or a sphere; nullopt for others. Throws InputError, without naming
/// the place, for text that is not JSON, and for axes that no body can have.
std::optional<ed::BodyShape> read_type_shape(const std::string& json);

}  // namespace hardbody
