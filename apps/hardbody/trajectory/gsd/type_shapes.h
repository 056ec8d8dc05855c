#pragma once

#include <ed/shape.h>

#include <cstddef>
#include <optional>
#include <string>

namespace hardbody {

/// A row of particles/type_shapes: {"type": "Ellipsoid", "a": .., "b": .., "c": ..}, semi-axes; of spheres {"type":
/// "Sphere", "diameter": ..}; of superellipsoids a "ConvexPolyhedron" with vertices on the surface (fewer where there
/// are many types); of users' own shapes {}.
std::string type_shape_json(const std::optional<ed::BodyShape>& shape, std::size_t types);

/// The shape of a row, if it is an ellipsoid or a sphere; nothing for others. Throws InputError, without saying where,
/// for what is not JSON, and for axes that no body can have.
std::optional<ed::BodyShape> read_type_shape(const std::string& json);

}  // namespace hardbody
