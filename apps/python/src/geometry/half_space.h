#pragma once

/// Half-spaces, which take part in queries of one pair and of one body, and in no arrays or simulations.

#include "base/arguments.h"

#include <geom/half_space.h>

#include <nanobind/nanobind.h>

#include <optional>

namespace hardbody::python {

/// Defines the class HalfSpace.
void bind_half_space(nb::module_& module);

/// Returns the half-space that an object is; nullptr if it is none.
const geom::HalfSpace* half_space(nb::handle value);

/// Returns the distance of two bodies if one of them is a half-space. Throws ValueError if both are.
std::optional<geom::DistanceResult> half_space_distance(nb::handle a, const geom::Pose& X_WA, nb::handle b,
                                                        const geom::Pose& X_WB);

}  // namespace hardbody::python
