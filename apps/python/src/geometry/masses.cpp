#include "base/arguments.h"
#include "base/arrays.h"
#include "base/gil.h"
#include "base/values.h"
#include "geometry/bind.h"
#include "geometry/bodies.h"
#include "geometry/shapes.h"

#include <geom/any_shape.h>
#include <geom/mass.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace hardbody::python {
namespace {

/// Volume and moments of a body of uniform density.
struct Mass {
  double density = 1;
  geom::MassProperties unit;  ///< properties at density 1

  double mass() const { return density * unit.volume; }
  Eigen::Vector3d center_of_mass() const { return unit.first_moment / unit.volume; }
  Eigen::Matrix3d inertia() const { return density * unit.inertia; }
};

/// Returns what an integration over directions gives; a volume of 0 for shapes without a surface f(x) = 0.
geom::MassProperties by_quadrature(const geom::Shape& shape, double tolerance) {
  const auto of = [&](const auto& s) {
    if constexpr (geom::ImplicitSurface<std::decay_t<decltype(s)>>) {
      return geom::mass_properties(s, s.bounding_radius(), tolerance);
    } else {
      return geom::MassProperties{};
    }
  };
  return std::visit(of, shape);
}

void warn_unless_reached(double error, double tolerance) {
  if (error <= tolerance) return;
  const std::string text = "mass_properties: the relative error is " + shown(error) + ", quadrature_tolerance " +
                           shown(tolerance) + " is not reached";
  if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 1) != 0) throw nb::python_error();
}

Mass mass_properties(nb::handle value, nb::handle density, nb::handle quadrature_tolerance) {
  const geom::Shape body = shape(value, "shape");
  Mass mass{positive(density, "density"), {}};
  if (!quadrature_tolerance.is_none()) {
    const double tolerance = positive(quadrature_tolerance, "quadrature_tolerance");
    {
      const GilReleased released;
      mass.unit = by_quadrature(body, tolerance);
    }
    if (mass.unit.volume > 0) {
      warn_unless_reached(mass.unit.relative_error, tolerance);
      return mass;
    }
    refuse_value("quadrature_tolerance", shown(tolerance), "None for a " + geom::description(body));
  }
  mass.unit = geom::mass_properties(body);
  return mass;
}

/// Returns densities of as many shapes, from one number or one each.
std::vector<double> densities(nb::handle value, std::size_t shapes) {
  const RealArray array(value, "density", "a number, or one a shape");
  const bool is_one = array.shape().empty();
  if (!is_one && array.shape() != std::vector{shapes}) {
    refuse_shape("density", array.shape(), "a number, or one a shape, shape (" + std::to_string(shapes) + ",)");
  }
  if (is_one) return std::vector<double>(shapes, positive(value, "density"));
  std::vector<double> read(array.data(), array.data() + shapes);
  for (std::size_t k = 0; k < shapes; ++k) {
    if (read[k] > 0 && std::isfinite(read[k])) continue;
    refuse_value("density[" + std::to_string(k) + ']', shown(read[k]), "a finite number above 0");
  }
  return read;
}

nb::tuple mass_properties_many(nb::handle shapes, nb::handle density) {
  const std::vector<geom::Shape> bodies = read_shapes(shapes);
  const std::size_t rows = bodies.size();
  const std::vector<double> each = densities(density, rows);
  const NewArray<double> volume = new_array<double>({rows}), mass = new_array<double>({rows});
  const NewArray<double> center = new_array<double>({rows, 3}), inertia = new_array<double>({rows, 3, 3});
  const NewArray<double> relative_error = new_array<double>({rows});
  {
    const GilReleased released;
    for (std::size_t k = 0; k < rows; ++k) {
      const Mass m{each[k], geom::mass_properties(bodies[k])};
      volume.data[k] = m.unit.volume;
      mass.data[k] = m.mass();
      Eigen::Vector3d::Map(center.data + 3 * k) = m.center_of_mass();
      Eigen::Matrix3d::Map(inertia.data + 9 * k) = m.inertia();  // symmetric
      relative_error.data[k] = m.unit.relative_error;
    }
  }
  return nb::make_tuple(volume.array, mass.array, center.array, inertia.array, relative_error.array);
}

}  // namespace

void bind_masses(nb::module_& module) {
  const auto array = [](const char* signature) { return nb::for_getter(nb::sig(signature)); };
  nb::class_<Mass> type(module, "MassProperties", nb::is_weak_referenceable(),
                        "Volume, mass and moments of a body of uniform density, body frame.");
  type.def_prop_ro(
          "volume", [](const Mass& m) { return m.unit.volume; }, "Volume, length^3.")
      .def_prop_ro(
          "mass", [](const Mass& m) { return m.mass(); }, "Density times volume.")
      .def_prop_ro(
          "center_of_mass", [](const Mass& m) { return array_of(m.center_of_mass()); },
          array("def center_of_mass(self) -> numpy.typing.NDArray[numpy.float64]"), "Centre of mass, shape (3,).")
      .def_prop_ro(
          "inertia", [](const Mass& m) { return array_of(m.inertia()); },
          array("def inertia(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Moments of inertia about the origin, shape (3, 3): integral of density (|x|^2 I - x x^T).")
      .def_prop_ro(
          "relative_error", [](const Mass& m) { return m.unit.relative_error; },
          "Bound (closed forms) or estimate (quadrature) of the relative error of volume and inertia.")
      .def("__repr__", [](const Mass& m) {
        const Eigen::Vector3d moments = m.inertia().diagonal();
        return "MassProperties(volume=" + shown(m.unit.volume) + ", mass=" + shown(m.mass()) + ", inertia=diag(" +
               shown(moments) + "), relative_error=" + shown(m.unit.relative_error) + ')';
      });
  bind_value(
      type, &Mass::density, [](auto& m) -> auto& { return m.unit.volume; },
      [](auto& m) -> auto& { return m.unit.first_moment; }, [](auto& m) -> auto& { return m.unit.inertia; },
      [](auto& m) -> auto& { return m.unit.relative_error; });
  module.def(
      "mass_properties", &mass_properties, nb::arg("shape").none(), nb::arg("density").none() = 1.0, nb::kw_only(),
      nb::arg("quadrature_tolerance") = nb::none(),
      nb::sig("def mass_properties(shape: hardbody.Shape, density: float = 1.0, *, "
              "quadrature_tolerance: float | None = None) -> MassProperties"),
      "Returns volume, mass and moments of inertia of a body of uniform density, by closed forms.\n"
      "\n"
      "With quadrature_tolerance, a relative error, they are integrated over the surface instead, in milliseconds, or\n"
      "in seconds where it is not reached: relative_error is then larger, and a RuntimeWarning says so. Ellipsoid,\n"
      "Superellipsoid, Sphere and Capsule take it, which have a surface f(x) = 0. The GIL is released.\n"
      "\n"
      "Raises ValueError or TypeError that names the argument and what is accepted: built-in shapes but HalfSpace.");
  module.def("mass_properties_many", &mass_properties_many, nb::arg("shapes").none(), nb::arg("density").none(),
             nb::sig("def mass_properties_many(shapes: typing.Any, density: typing.Any) -> tuple[typing.Any, ...]"));
}

}  // namespace hardbody::python
