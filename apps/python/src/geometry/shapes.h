#pragma once

#include "base/arguments.h"
#include "geometry/custom_shape.h"

#include <ed/shape.h>
#include <geom/shape_variant.h>

#include <nanobind/nanobind.h>

#include <string>
#include <variant>

namespace hardbody::python {

/// Returns the shape of a Python object. Throws TypeError if it is none.
inline geom::Shape shape(nb::handle value, const std::string& name) {
  return OneOf<geom::Shape>::from(value, name);
}

/// Returns the shape of a body in motion, a user's own included. Throws TypeError if the object is none.
inline ed::BodyShape body_shape(nb::handle value, const std::string& name) {
  if (OneOf<ed::BodyShape>::holds(value) || !is_custom_shape(value)) return OneOf<ed::BodyShape>::from(value, name);
  return custom_shape_of(value);
}

/// Returns a shape as Python has it: a user's own as a CustomShape.
inline nb::object shape_object(const ed::BodyShape& shape) {
  return std::visit([](const auto& s) { return nb::cast(s); }, shape);
}

}  // namespace hardbody::python
