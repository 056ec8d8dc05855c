#pragma once

/// Shapes as JSON. Private to the sources that read and write JSON, because it includes the parser.

#include "base/shapes.h"
#include "io/json_member.h"

#include <geom/half_space.h>
#include <geom/shape_variant.h>

#include <nlohmann/json.hpp>

namespace hardbody {

/// Reads the numbers of an ellipsoid or superellipsoid, whose kind is known.
geom::Shape read_shape(const JsonMember& shape, ShapeKind kind);

/// Reads {"kind": .., ..}, of one of these kinds, with no other keys:
///
///     "ellipsoid"       "semi_axes": [a, b, c]
///     "superellipsoid"  "semi_axes": [a, b, c], "exponents": [e1, e2]
///     "sphere"          "radius": r
///     "capsule"         "half_length": l, "radius": r
///     "box"             "half_extents": [a, b, c], "rounding": r
///     "polyhedron"      "vertices": [[x, y, z], ..], "rounding": r
///     "polyhedron"      "solid": name (geom::solid_vertices), "circumradius": R, "rounding": r
///     "cylinder"        "half_length": l, "radius": r, "rounding": r
///     "cone"            "height": h, "radius": r, "base": z, "rounding": r
///
/// Without "rounding" edges are sharp; "circumradius" is 1 by default. `also`: what else is accepted as a kind, in
/// messages.
geom::Shape read_shape(const JsonMember& shape, const char* also = "");

/// Returns whether a shape is of the kind "half_space".
bool is_half_space(const JsonMember& shape);

/// Reads {"kind": "half_space", "normal": [x, y, z], "offset": d}; without them it is z <= 0.
geom::HalfSpace read_half_space(const JsonMember& shape);

/// Returns a shape as read_shape() reads it, to the same bits. Throws std::logic_error for a user's shape.
nlohmann::ordered_json shape_json(const ed::BodyShape& shape);

}  // namespace hardbody
