#include "geometry/shapes.h"

#include "base/arguments.h"
#include "base/arrays.h"
#include "geometry/bind.h"
#include "geometry/bind_shape.h"

#include <geom/ellipsoid.h>
#include <geom/superellipsoid.h>
#include <geom/tolerances.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace hardbody::python {
namespace {

using geom::Ellipsoid;
using geom::Superellipsoid;

std::string constructor_text(const Ellipsoid& shape) {
  return "Ellipsoid(" + shown(shape.semi_axes()) + ")";
}

std::string constructor_text(const Superellipsoid& shape) {
  return "Superellipsoid(" + shown(shape.semi_axes()) + ", " + shown(shape.e1()) + ", " + shown(shape.e2()) + ")";
}

bool equal(const Ellipsoid& a, const Ellipsoid& b) {
  return a.semi_axes() == b.semi_axes();
}

bool equal(const Superellipsoid& a, const Superellipsoid& b) {
  return a.semi_axes() == b.semi_axes() && a.e1() == b.e1() && a.e2() == b.e2();
}

nb::tuple constructor_arguments(const Ellipsoid& shape) {
  return nb::make_tuple(array_of(shape.semi_axes()));
}

nb::tuple constructor_arguments(const Superellipsoid& shape) {
  return nb::make_tuple(array_of(shape.semi_axes()), shape.e1(), shape.e2());
}

void bind_ellipsoid(nb::module_& module) {
  nb::class_<Ellipsoid> type(module, "Ellipsoid", nb::is_weak_referenceable(),
                             "Ellipsoid (x/a)^2 + (y/b)^2 + (z/c)^2 <= 1 in the body's frame.");
  type.def(
          "__init__", [](Ellipsoid* self, nb::handle axes) { new (self) Ellipsoid(vector3(axes, "semi_axes")); },
          nb::arg("semi_axes").none(), nb::sig("def __init__(self, semi_axes: numpy.typing.ArrayLike) -> None"),
          "Constructs an ellipsoid from its semi-axes (a, b, c) along body x, y, z, shape (3,), each from 1e-50 to\n"
          "1e50 and the largest at most 1e4 times the smallest. Raises ValueError otherwise.")
      .def_static(
          "spheroid",
          [](nb::handle aspect_ratio) {
            const double ratio = positive(aspect_ratio, "aspect_ratio");
            if (std::max(ratio, 1 / ratio) > geom::kMaxAspectRatio) {
              refuse_value("aspect_ratio", shown(ratio), "0.0001 to 10000");
            }
            const double across = 1 / std::cbrt(ratio);
            return Ellipsoid({across, across, ratio * across});
          },
          nb::arg("aspect_ratio").none(), nb::sig("def spheroid(aspect_ratio: float) -> Ellipsoid"),
          "Returns the ellipsoid of revolution about body z with a/b = aspect_ratio (prolate above 1, oblate below)\n"
          "and the volume of the unit sphere, a b^2 = 1: the unit of length of simulations.")
      .def_prop_ro(
          "semi_axes", [](const Ellipsoid& s) { return array_of(s.semi_axes()); },
          nb::for_getter(nb::sig("def semi_axes(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Semi-axes along body x, y, z, shape (3,).");
  bind_common(type, {constructor_text, equal, constructor_arguments});
}

void bind_superellipsoid(nb::module_& module) {
  nb::class_<Superellipsoid> type(
      module, "Superellipsoid", nb::is_weak_referenceable(),
      "Barr's superellipsoid (|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1) <= 1 in the body's frame.\n"
      "\n"
      "Exponents below 1 give flat faces and rounded edges (a box towards 0), 1 the ellipsoid, above 1 edges\n"
      "(an octahedron at 2). e1 shapes the profile along z, e2 the section across it.");
  type.def(
          "__init__",
          [](Superellipsoid* self, nb::handle axes, nb::handle e1, nb::handle e2) {
            new (self) Superellipsoid(vector3(axes, "semi_axes"), number(e1, "e1"), number(e2, "e2"));
          },
          nb::arg("semi_axes").none(), nb::arg("e1").none(), nb::arg("e2").none(),
          nb::sig("def __init__(self, semi_axes: numpy.typing.ArrayLike, e1: float, e2: float) -> None"),
          "Constructs a superellipsoid from its semi-axes along body x, y, z, shape (3,), as for Ellipsoid, and its\n"
          "exponents, each from 0.2 to 1.6. Raises ValueError otherwise.")
      .def_prop_ro(
          "semi_axes", [](const Superellipsoid& s) { return array_of(s.semi_axes()); },
          nb::for_getter(nb::sig("def semi_axes(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Semi-axes along body x, y, z, shape (3,).")
      .def_prop_ro("e1", &Superellipsoid::e1, "Exponent of the profile along z.")
      .def_prop_ro("e2", &Superellipsoid::e2, "Exponent of the section across z.");
  bind_common(type, {constructor_text, equal, constructor_arguments});
}

}  // namespace

void bind_shapes(nb::module_& module) {
  bind_ellipsoid(module);
  bind_superellipsoid(module);
  bind_core_shapes(module);
}

}  // namespace hardbody::python
