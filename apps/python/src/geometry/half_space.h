#pragma once

/// Half-spaces, which take part in queries of one pair and of one body, and in no arrays or simulations.

#include "base/arguments.h"

#include <geom/any_convex.h>
#include <geom/half_space.h>
#include <geom/shape_variant.h>

#include <nanobind/nanobind.h>

#include <optional>
#include <variant>

namespace hardbody::python {

/// Defines the class HalfSpace.
void bind_half_space(nb::module_& module);

/// Returns the half-space that an object is; nullptr if it is none.
const geom::HalfSpace* half_space(nb::handle value);

/// Throws TypeError if both bodies are half-spaces.
void refuse_two_half_spaces(nb::handle a, nb::handle b);

/// Returns the distance of two bodies if one of them is a half-space. Throws TypeError if both are.
std::optional<geom::DistanceResult> half_space_distance(nb::handle a, const geom::Pose& X_WA, nb::handle b,
                                                        const geom::Pose& X_WB);

/// Body of a query as libgeom's templates take it.
using QueryBody = std::variant<geom::Shape, geom::AnyConvex, geom::HalfSpace>;

/// Returns the body of a query. Throws TypeError if the object is none.
QueryBody query_body(nb::handle value, const char* name);

}  // namespace hardbody::python
