#include "geometry/half_space.h"

#include "base/arrays.h"
#include "geometry/shapes.h"

#include <nanobind/stl/string.h>

#include <string>

namespace hardbody::python {
namespace {

using geom::HalfSpace;

std::string half_space_text(const HalfSpace& s) {
  return "HalfSpace(" + shown(s.normal()) + ", " + shown(s.offset()) + ")";
}

}  // namespace

const HalfSpace* half_space(nb::handle value) {
  HalfSpace* found = nullptr;
  return nb::try_cast(value, found, false) ? found : nullptr;
}

void refuse_two_half_spaces(nb::handle a, nb::handle b) {
  if (half_space(a) != nullptr && half_space(b) != nullptr) refuse_type("b", b, "a body, as a is a HalfSpace");
}

std::optional<geom::DistanceResult> half_space_distance(nb::handle a, const geom::Pose& X_WA, nb::handle b,
                                                        const geom::Pose& X_WB) {
  const HalfSpace* below_a = half_space(a);
  const HalfSpace* below_b = half_space(b);
  refuse_two_half_spaces(a, b);
  if (below_a != nullptr) return geom::distance(*below_a, X_WA, shape(b, "b"), X_WB);
  if (below_b != nullptr) return geom::kernel::exchanged(geom::distance(*below_b, X_WB, shape(a, "a"), X_WA));
  return std::nullopt;
}

QueryBody query_body(nb::handle value, const char* name) {
  if (const HalfSpace* const plane = half_space(value)) return *plane;
  return std::visit([](const auto& s) -> QueryBody { return s; }, geom_shape(query_shape(value, name)));
}

void bind_half_space(nb::module_& module) {
  nb::class_<HalfSpace>(
      module, "HalfSpace", nb::is_weak_referenceable(),
      "Half-space normal.x <= offset in the body's frame, such as a floor: for the queries of one body or of a\n"
      "pair, contact_patch and distance_derivatives too, beside any built-in shape.")
      .def(
          "__init__",
          [](HalfSpace* self, nb::handle normal, nb::handle offset) {
            const Eigen::Vector3d n = normal.is_none() ? Eigen::Vector3d::UnitZ() : direction3(normal, "normal");
            new (self) HalfSpace(n, finite_number(offset, "offset"));
          },
          nb::arg("normal") = nb::none(), nb::arg("offset").none() = 0.0,
          nb::sig("def __init__(self, normal: numpy.typing.ArrayLike | None = None, offset: float = 0.0) -> None"),
          "Constructs a half-space from its outward normal, shape (3,), of any length but 0 (None: z), and the offset\n"
          "of its plane along the unit normal.")
      .def_prop_ro(
          "normal", [](const HalfSpace& s) { return array_of(s.normal()); },
          nb::for_getter(nb::sig("def normal(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Unit outward normal, shape (3,).")
      .def_prop_ro("offset", &HalfSpace::offset, "Distance of the plane from the origin along the normal.")
      .def("__repr__", [](const HalfSpace& s) { return half_space_text(s); })
      .def(
          "__eq__",
          [](const HalfSpace& s, nb::handle other) {
            const HalfSpace* found = half_space(other);
            return found != nullptr && found->normal() == s.normal() && found->offset() == s.offset();
          },
          nb::arg("other").none(), nb::sig("def __eq__(self, other: typing.Any, /) -> bool"))
      .def("__hash__", [](const HalfSpace& s) { return nb::hash(nb::str(half_space_text(s).c_str())); })
      .def(
          "__reduce__",
          [](nb::handle self) {
            const auto& s = nb::cast<const HalfSpace&>(self);
            return nb::make_tuple(self.type(), nb::make_tuple(array_of(s.normal()), s.offset()));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
}

}  // namespace hardbody::python
