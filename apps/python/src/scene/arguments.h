#pragma once

/// Arguments of scenes as C++ values. Messages are those of base/arguments.h.

#include <ed/shape.h>

#include <geom/pose.h>
#include <geom/scene.h>

#include <nanobind/nanobind.h>

#include <vector>

namespace hardbody::python {

namespace nb = nanobind;

/// Returns a shape as scenes take it.
geom::SceneShape scene_shape(const ed::BodyShape& shape);

/// Returns the pose of an object. Throws TypeError if it is none.
const geom::Pose& checked_pose(nb::handle value);

/// Returns a handle, whether a body has it or not.
geom::BodyId handle_of(nb::handle value, const char* name);

/// Returns the handles of an array, the argument `bodies`.
std::vector<geom::BodyId> handles_of(nb::handle value);

/// Returns the filter of two numbers of 32 bits.
geom::Filter filter_of(nb::handle group, nb::handle meets);

/// Returns the lattice: None, the edge of a cube, or three vectors as rows.
geom::Lattice lattice_of(nb::handle value);

/// Returns the margin, a finite length of 0 or more.
double margin_of(nb::handle value);

/// Returns a length that may be infinite.
double reach(nb::handle value, const char* name);

}  // namespace hardbody::python
