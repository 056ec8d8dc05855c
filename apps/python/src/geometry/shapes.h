#pragma once

#include "base/arguments.h"
#include "geometry/custom_shape.h"

#include <ed/shape.h>
#include <geom/any_convex.h>
#include <geom/shape_variant.h>

#include <nanobind/nanobind.h>

#include <string>
#include <variant>

namespace hardbody::python {

/// Returns the shape of a Python object. Throws TypeError if it is none.
inline geom::Shape shape(nb::handle value, const std::string& name) {
  return OneOf<geom::Shape>::from(value, name);
}

/// Returns the shape of a body in motion, a user's own included. Throws TypeError if the object is none; its message
/// lists the classes, and `others` after them.
inline ed::BodyShape body_shape(nb::handle value, const std::string& name, const std::string& others = "") {
  if (OneOf<ed::BodyShape>::holds(value) || !is_custom_shape(value)) {
    return OneOf<ed::BodyShape>::from(value, name, others);
  }
  return custom_shape_of(value);
}

/// Returns the shape of a body in a query that takes half-spaces, too, which are looked for before.
inline ed::BodyShape query_shape(nb::handle value, const std::string& name) {
  return body_shape(value, name, ", HalfSpace");
}

/// Returns the shape of a body as libgeom has it: a user's own, which is none of its kinds, is type-erased.
inline std::variant<geom::Shape, geom::AnyConvex> geom_shape(const ed::BodyShape& shape) {
  return std::visit(
      [](const auto& s) -> std::variant<geom::Shape, geom::AnyConvex> {
        if constexpr (requires { geom::Shape(s); }) {
          return geom::Shape(s);
        } else {
          return geom::AnyConvex(s);
        }
      },
      shape);
}

/// Returns a shape as Python has it: a user's own as a CustomShape.
inline nb::object shape_object(const ed::BodyShape& shape) {
  return std::visit([](const auto& s) { return nb::cast(s); }, shape);
}

}  // namespace hardbody::python
