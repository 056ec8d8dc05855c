#pragma once

/// Attributes and methods that every class of shapes has in Python.

#include "base/arguments.h"
#include "base/arrays.h"

#include <geom/shape.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cmath>

namespace hardbody::python {

/// Functions of a kind of shape that its class is made of.
template <class Shape>
struct ShapeCalls {
  std::string (*text)(const Shape&);          ///< call of the constructor that makes the shape
  bool (*equal)(const Shape&, const Shape&);  ///< comparison of all numbers
  nb::tuple (*arguments)(const Shape&);       ///< arguments of that call
};

/// Returns the support in a direction of any length: squares of its components neither overflow nor vanish.
template <class Shape>
geom::Support support_of(const Shape& shape, const Eigen::Vector3d& n) {
  const int exponent = std::ilogb(n.cwiseAbs().maxCoeff());
  geom::Support support = shape.support(n.unaryExpr([=](double x) { return std::ldexp(x, -exponent); }));
  support.height = std::ldexp(support.height, exponent);
  return support;
}

/// Defines what every shape has.
template <class Shape>
void bind_common(nb::class_<Shape>& type, const ShapeCalls<Shape>& calls) {
  // Of a subclass, too, the shape made is of the class itself.
  const std::string scaled = "def scaled(self, factor: float) -> " + nb::cast<std::string>(type.attr("__name__"));
  type.def_prop_ro(
          "bounding_radius", [](const Shape& s) { return s.bounding_radius(); },
          "Radius of the smallest sphere about the origin that contains the body.")
      .def_prop_ro(
          "inscribed_radius", [](const Shape& s) { return s.inscribed_radius(); },
          "Radius of the largest sphere about the origin that the body contains.")
      .def_prop_ro(
          "min_curvature_radius", [](const Shape& s) { return s.min_curvature_radius(); },
          "Lower bound of the smallest radius of curvature of the surface: overlaps down to the sum of both\n"
          "bodies' values are answered without a search.")
      .def_prop_ro(
          "volume", [](const Shape& s) { return s.volume(); }, "Volume, in units of length^3.")
      .def_prop_ro(
          "symmetry_axis", [](const Shape& s) { return s.symmetry_axis(); },
          "Index (0, 1, 2) of the body's axis of revolution, 2 if all are; None if it has none.")
      .def(
          "inertia", [](const Shape& s, nb::handle mass) { return array_of(s.inertia(positive(mass, "mass"))); },
          nb::arg("mass").none() = 1.0,
          nb::sig("def inertia(self, mass: float = 1.0) -> numpy.typing.NDArray[numpy.float64]"),
          "Returns the principal moments of inertia about body x, y, z at uniform density, shape (3,), in units of\n"
          "mass times length^2.")
      .def(
          "scaled", [](const Shape& s, nb::handle factor) { return s.scaled(positive(factor, "factor")); },
          nb::arg("factor").none(), nb::sig(scaled.c_str()), "Returns the shape of `factor` times the size.")
      .def(
          "support",
          [](const Shape& s, nb::handle n) {
            const geom::Support support = support_of(s, direction3(n, "n"));
            return nb::make_tuple(support.height, array_of(support.point));
          },
          nb::arg("n").none(),
          nb::sig("def support(self, n: numpy.typing.ArrayLike) -> tuple[float, numpy.typing.NDArray[numpy.float64]]"),
          "Returns (h, s) for a direction n, shape (3,), of any length but 0: h(n) = max of n.x over the body, and\n"
          "the point s where that maximum is reached. Body frame.")
      .def("__repr__", calls.text)
      .def(
          "__eq__",
          [equal = calls.equal](const Shape& s, nb::handle other) {
            Shape* found = nullptr;
            return nb::try_cast(other, found, false) && found != nullptr && equal(s, *found);
          },
          nb::arg("other").none(), nb::sig("def __eq__(self, other: typing.Any, /) -> bool"))
      .def("__hash__", [text = calls.text](const Shape& s) { return nb::hash(nb::str(text(s).c_str())); })
      .def(
          "__reduce__",
          [arguments = calls.arguments](nb::handle self) {
            return nb::make_tuple(self.type(), arguments(nb::cast<const Shape&>(self)));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
}

}  // namespace hardbody::python
