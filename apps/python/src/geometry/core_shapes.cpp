#include "base/arguments.h"
#include "base/arrays.h"
#include "geometry/bind.h"
#include "geometry/bind_shape.h"
#include "geometry/half_space.h"

#include <geom/polyhedron.h>
#include <geom/round_shapes.h>
#include <geom/rounded.h>
#include <geom/tolerances.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

namespace hardbody::python {
namespace {

using Eigen::Vector3d;
using geom::Box;
using geom::Capsule;
using geom::Cone;
using geom::ConvexPolyhedron;
using geom::Cylinder;
using geom::Rounded;
using geom::Sphere;

constexpr const char* kVector = "(self) -> numpy.typing.NDArray[numpy.float64]";

std::string getter(const char* name) {
  return std::string("def ") + name + kVector;
}

// ---- Texts, comparison and pickling

std::string constructor_text(const Sphere& s) {
  return "Sphere(" + shown(s.radius()) + ")";
}
std::string constructor_text(const Capsule& s) {
  return "Capsule(" + shown(s.half_length()) + ", " + shown(s.radius()) + ")";
}
std::string constructor_text(const Box& s) {
  return "Box(" + shown(s.half_extents()) + ")";
}
std::string constructor_text(const ConvexPolyhedron& s) {
  std::string points;
  for (int k = 0; k < s.vertex_count(); ++k) points += (k == 0 ? "" : ", ") + shown(s.vertex(k));
  return "ConvexPolyhedron([" + points + "])";
}
std::string constructor_text(const Cylinder& s) {
  return "Cylinder(" + shown(s.half_length()) + ", " + shown(s.radius()) + ")";
}
std::string constructor_text(const Cone& s) {
  return "Cone(" + shown(s.height()) + ", " + shown(s.radius()) + ", " + shown(s.base()) + ")";
}
std::string constructor_text(const Rounded<Box>& s) {
  return "RoundedBox(" + constructor_text(s.inner()) + ", " + shown(s.radius()) + ")";
}
std::string constructor_text(const Rounded<ConvexPolyhedron>& s) {
  return "RoundedPolyhedron(" + constructor_text(s.inner()) + ", " + shown(s.radius()) + ")";
}

std::string constructor_text(const Rounded<Cylinder>& s) {
  return "RoundedCylinder(" + constructor_text(s.inner()) + ", " + shown(s.radius()) + ")";
}
std::string constructor_text(const Rounded<Cone>& s) {
  return "RoundedCone(" + constructor_text(s.inner()) + ", " + shown(s.radius()) + ")";
}

bool equal(const Sphere& a, const Sphere& b) {
  return a.radius() == b.radius();
}
bool equal(const Capsule& a, const Capsule& b) {
  return a.half_length() == b.half_length() && a.radius() == b.radius();
}
bool equal(const Box& a, const Box& b) {
  return a.half_extents() == b.half_extents();
}
bool equal(const ConvexPolyhedron& a, const ConvexPolyhedron& b) {
  if (a.vertex_count() != b.vertex_count()) return false;
  for (int k = 0; k < a.vertex_count(); ++k) {
    if (a.vertex(k) != b.vertex(k)) return false;
  }
  return true;
}
bool equal(const Cylinder& a, const Cylinder& b) {
  return a.half_length() == b.half_length() && a.radius() == b.radius();
}
bool equal(const Cone& a, const Cone& b) {
  return a.height() == b.height() && a.radius() == b.radius() && a.base() == b.base();
}
template <class Inner>
bool equal(const Rounded<Inner>& a, const Rounded<Inner>& b) {
  return equal(a.inner(), b.inner()) && a.radius() == b.radius();
}

/// Returns the vertices, shape (n, 3).
nb::object vertices(const ConvexPolyhedron& s) {
  const auto count = static_cast<std::size_t>(s.vertex_count());
  const NewArray<double> rows = new_array<double>({count, 3});
  for (std::size_t k = 0; k < count; ++k) Vector3d::Map(rows.data + 3 * k) = s.vertex(static_cast<int>(k));
  return rows.array;
}

nb::tuple constructor_arguments(const Sphere& s) {
  return nb::make_tuple(s.radius());
}
nb::tuple constructor_arguments(const Capsule& s) {
  return nb::make_tuple(s.half_length(), s.radius());
}
nb::tuple constructor_arguments(const Box& s) {
  return nb::make_tuple(array_of(s.half_extents()));
}
nb::tuple constructor_arguments(const ConvexPolyhedron& s) {
  return nb::make_tuple(vertices(s));
}
nb::tuple constructor_arguments(const Cylinder& s) {
  return nb::make_tuple(s.half_length(), s.radius());
}
nb::tuple constructor_arguments(const Cone& s) {
  return nb::make_tuple(s.height(), s.radius(), s.base());
}
template <class Inner>
nb::tuple constructor_arguments(const Rounded<Inner>& s) {
  return nb::make_tuple(s.inner(), s.radius());
}

// ---- Classes

/// Returns a length of a shape, at least kMinSemiAxis.
double length(nb::handle value, const char* name) {
  const double given = number(value, name);
  if (given >= geom::kMinSemiAxis && given <= geom::kMaxSemiAxis) return given;
  refuse_value(name, shown(given), shown(geom::kMinSemiAxis) + " to " + shown(geom::kMaxSemiAxis));
}

/// Returns the points of an array of shape (n, 3), all finite.
std::vector<Vector3d> points_of(nb::handle value) {
  const RealRows rows(value, "points", 3);
  std::vector<Vector3d> points;
  for (std::size_t k = 0; k < rows.size(); ++k) points.push_back(rows.finite_vector(k));
  return points;
}

void bind_sphere(nb::module_& module) {
  nb::class_<Sphere> type(module, "Sphere", nb::is_weak_referenceable(), "Ball |x| <= radius.");
  type.def(
          "__init__", [](Sphere* self, nb::handle radius) { new (self) Sphere(length(radius, "radius")); },
          nb::arg("radius").none(), nb::sig("def __init__(self, radius: float) -> None"),
          "Constructs a ball; the radius is from 1e-50 to 1e50.")
      .def_prop_ro("radius", &Sphere::radius, "Radius of the ball.");
  bind_common(type, {constructor_text, equal, constructor_arguments});
}

void bind_capsule(nb::module_& module) {
  nb::class_<Capsule> type(
      module, "Capsule", nb::is_weak_referenceable(),
      "Capsule (spherocylinder): all points within `radius` of the segment from -half_length to half_length along z.");
  type.def(
          "__init__",
          [](Capsule* self, nb::handle half_length, nb::handle radius) {
            new (self) Capsule(number(half_length, "half_length"), length(radius, "radius"));
          },
          nb::arg("half_length").none(), nb::arg("radius").none(),
          nb::sig("def __init__(self, half_length: float, radius: float) -> None"),
          "Constructs a capsule; the half-length, of at least 0, plus the radius is at most 1e4 times the radius.")
      .def_prop_ro("half_length", &Capsule::half_length, "Half the distance of the centres of the caps.")
      .def_prop_ro("radius", &Capsule::radius, "Radius of the caps and of the cylinder between them.");
  bind_common(type, {constructor_text, equal, constructor_arguments});
}

void bind_box(nb::module_& module) {
  nb::class_<Box> type(module, "Box", nb::is_weak_referenceable(),
                       "Box |x_k| <= half_extents_k in the body's frame, with sharp edges.");
  type.def(
          "__init__", [](Box* self, nb::handle half) { new (self) Box(vector3(half, "half_extents")); },
          nb::arg("half_extents").none(), nb::sig("def __init__(self, half_extents: numpy.typing.ArrayLike) -> None"),
          "Constructs a box from half its edges along body x, y, z, shape (3,), each from 1e-50 to 1e50 and the\n"
          "largest at most 1e4 times the smallest.")
      .def_prop_ro(
          "half_extents", [](const Box& s) { return array_of(s.half_extents()); },
          nb::for_getter(nb::sig(getter("half_extents").c_str())), "Half the edges along body x, y, z, shape (3,).");
  bind_common(type, {constructor_text, equal, constructor_arguments});
}

/// Defines what polyhedra, rounded or not, have beside bind_common().
template <class Shape>
void bind_moments(nb::class_<Shape>& type) {
  type.def_prop_ro(
          "center_of_mass", [](const Shape& s) { return array_of(Vector3d(s.centre_of_mass())); },
          nb::for_getter(nb::sig(getter("center_of_mass").c_str())), "Centre of mass, body frame, shape (3,).")
      .def_prop_ro(
          "is_in_principal_frame", &Shape::is_in_principal_frame,
          "Whether the centre of mass is the origin and the axes are the principal ones, to 1e-9 of the size.\n"
          "A species of uniform density needs it; in_principal_frame of ConvexPolyhedron and Cone moves shapes there.");
}

nb::tuple in_principal_frame(nb::handle points, nb::handle rounding) {
  geom::Pose X_BP;
  const double radius = number(rounding, "rounding");
  const ConvexPolyhedron shape = ConvexPolyhedron::in_principal_frame(points_of(points), &X_BP, radius);
  return nb::make_tuple(shape, X_BP);
}

ConvexPolyhedron solid(nb::handle name, nb::handle circumradius) {
  std::string names;
  for (const std::string_view known : geom::solid_names()) names += (names.empty() ? "" : ", ") + std::string(known);
  const double radius = length(circumradius, "circumradius");
  std::vector<Vector3d> points = geom::solid_vertices(text(name, "name", names));
  for (Vector3d& x : points) x *= radius;
  return ConvexPolyhedron(points);
}

void bind_polyhedron(nb::module_& module) {
  nb::class_<ConvexPolyhedron> type(module, "ConvexPolyhedron", nb::is_weak_referenceable(),
                                    "Convex hull of points, with sharp edges.");
  type.def(
          "__init__", [](ConvexPolyhedron* self, nb::handle points) { new (self) ConvexPolyhedron(points_of(points)); },
          nb::arg("points").none(), nb::sig("def __init__(self, points: numpy.typing.ArrayLike) -> None"),
          "Constructs the convex hull of points, shape (n, 3), n >= 4, with exact decisions: points inside, on faces\n"
          "or given twice are no vertices. Raises ValueError if they lie in a plane, or the origin is not inside.")
      .def_static("solid", &solid, nb::arg("name").none(), nb::arg("circumradius").none() = 1.0,
                  nb::sig("def solid(name: str, circumradius: float = 1.0) -> ConvexPolyhedron"),
                  "Returns a Platonic or Archimedean solid: 'tetrahedron', 'cube', 'octahedron', 'dodecahedron',\n"
                  "'icosahedron', 'truncated cube', ... 'snub dodecahedron'.")
      .def_static(
          "in_principal_frame", &in_principal_frame, nb::arg("points").none(), nb::arg("rounding").none() = 0.0,
          nb::sig("def in_principal_frame(points: numpy.typing.ArrayLike, rounding: float = 0.0) "
                  "-> tuple[ConvexPolyhedron, Pose]"),
          "Returns (polyhedron, pose): the hull of points, shape (n, 3), in the frame of its principal axes, from its\n"
          "centre of mass, and that frame's pose in the points' own. With `rounding`, those of the rounded hull.")
      .def_prop_ro("vertices", &vertices, nb::for_getter(nb::sig(getter("vertices").c_str())),
                   "Vertices in the body's frame, shape (n, 3).")
      .def_prop_ro("faces", &geom::merged_faces,
                   "Faces, each a list of indices of vertices, anticlockwise seen from outside. Faces in a plane to\n"
                   "rounding, 1e-12 of the bounding radius, are merged; made at each access.");
  bind_common(type, {constructor_text, equal, constructor_arguments});
  bind_moments(type);
}

void bind_cylinder(nb::module_& module) {
  nb::class_<Cylinder> type(module, "Cylinder", nb::is_weak_referenceable(),
                            "Circular cylinder about z, from -half_length to half_length, with sharp rims.");
  type.def(
          "__init__",
          [](Cylinder* self, nb::handle half_length, nb::handle radius) {
            new (self) Cylinder(length(half_length, "half_length"), length(radius, "radius"));
          },
          nb::arg("half_length").none(), nb::arg("radius").none(),
          nb::sig("def __init__(self, half_length: float, radius: float) -> None"),
          "Constructs a cylinder; neither length is more than 1e4 times the other.")
      .def_prop_ro("half_length", &Cylinder::half_length, "Half the distance of the faces.")
      .def_prop_ro("radius", &Cylinder::radius, "Radius of the faces.");
  bind_common(type, {constructor_text, equal, constructor_arguments});
}

Cone make_cone(nb::handle height, nb::handle radius, nb::handle base) {
  const double h = length(height, "height");
  const double r = length(radius, "radius");
  return base.is_none() ? Cone(h, r) : Cone(h, r, number(base, "base"));
}

Cone cone_in_principal_frame(nb::handle height, nb::handle radius, nb::handle rounding) {
  return Cone::in_principal_frame(length(height, "height"), length(radius, "radius"), number(rounding, "rounding"));
}

void bind_cone(nb::module_& module) {
  nb::class_<Cone> type(module, "Cone", nb::is_weak_referenceable(),
                        "Circular cone about z, its apex above its base, with a sharp rim.");
  type.def(
          "__init__",
          [](Cone* self, nb::handle height, nb::handle radius, nb::handle base) {
            new (self) Cone(make_cone(height, radius, base));
          },
          nb::arg("height").none(), nb::arg("radius").none(), nb::arg("base").none() = nb::none(),
          nb::sig("def __init__(self, height: float, radius: float, base: float | None = None) -> None"),
          "Constructs a cone with its base at z = base, below the origin; None: its centre of mass is the origin.")
      .def_static("in_principal_frame", &cone_in_principal_frame, nb::arg("height").none(), nb::arg("radius").none(),
                  nb::arg("rounding").none(),
                  nb::sig("def in_principal_frame(height: float, radius: float, rounding: float) -> Cone"),
                  "Returns the cone whose origin is the centre of mass of the cone rounded by `rounding`.")
      .def_prop_ro("height", &Cone::height, "Distance of the apex from the base.")
      .def_prop_ro("radius", &Cone::radius, "Radius of the base.")
      .def_prop_ro("base", &Cone::base, "z of the base, body frame.");
  bind_common(type, {constructor_text, equal, constructor_arguments});
  bind_moments(type);
}

/// Returns the argument `shape` of a rounded shape of this kind.
template <class Inner>
const Inner& inner_of(nb::handle value) {
  return instance<Inner>(value, "shape");
}

template <class Inner>
void bind_rounded(nb::module_& module, const char* name, const char* inner, const char* doc) {
  nb::class_<Rounded<Inner>> type(module, name, nb::is_weak_referenceable(), doc);
  const std::string init = std::string("def __init__(self, shape: ") + inner + ", radius: float) -> None";
  const std::string of = std::string("def shape(self) -> ") + inner;
  type.def(
          "__init__",
          [](Rounded<Inner>* self, nb::handle shape, nb::handle radius) {
            new (self) Rounded<Inner>(inner_of<Inner>(shape), number(radius, "radius"));
          },
          nb::arg("shape").none(), nb::arg("radius").none(), nb::sig(init.c_str()),
          "Constructs all points within `radius`, of at least 0, of a shape.")
      .def_prop_ro(
          "shape", [](const Rounded<Inner>& s) { return s.inner(); }, nb::for_getter(nb::sig(of.c_str())),
          "Shape that is rounded.")
      .def_prop_ro("radius", &Rounded<Inner>::radius, "Radius of the ball.");
  bind_common(type, {constructor_text, equal, constructor_arguments});
  bind_moments(type);
}

nb::object rounded(nb::handle shape, nb::handle radius) {
  const double r = number(radius, "radius");
  if (nb::isinstance<Box>(shape)) return nb::cast(Rounded<Box>(inner_of<Box>(shape), r));
  if (nb::isinstance<ConvexPolyhedron>(shape)) {
    return nb::cast(Rounded<ConvexPolyhedron>(inner_of<ConvexPolyhedron>(shape), r));
  }
  if (nb::isinstance<Cylinder>(shape)) return nb::cast(Rounded<Cylinder>(inner_of<Cylinder>(shape), r));
  if (nb::isinstance<Cone>(shape)) return nb::cast(Rounded<Cone>(inner_of<Cone>(shape), r));
  refuse_type("shape", shape, "Box, ConvexPolyhedron, Cylinder, Cone");
}

}  // namespace

void bind_core_shapes(nb::module_& module) {
  bind_sphere(module);
  bind_capsule(module);
  bind_box(module);
  bind_polyhedron(module);
  bind_cylinder(module);
  bind_cone(module);
  bind_rounded<Box>(module, "RoundedBox", "Box", "Box with a ball swept over it: what Rounded returns for a Box.");
  bind_rounded<ConvexPolyhedron>(module, "RoundedPolyhedron", "ConvexPolyhedron",
                                 "Polyhedron with a ball swept over it: what Rounded returns for a ConvexPolyhedron.");
  bind_rounded<Cylinder>(module, "RoundedCylinder", "Cylinder",
                         "Cylinder with a ball swept over it: what Rounded returns for a Cylinder.");
  bind_rounded<Cone>(module, "RoundedCone", "Cone", "Cone with a ball swept over it: what Rounded returns for a Cone.");
  module.def("Rounded", &rounded, nb::arg("shape").none(), nb::arg("radius").none(),
             nb::sig("def Rounded(shape: Box | ConvexPolyhedron | Cylinder | Cone, radius: float) "
                     "-> RoundedBox | RoundedPolyhedron | RoundedCylinder | RoundedCone"),
             "Returns all points within `radius`, of at least 0, of a box, polyhedron, cylinder or cone. Overlaps no\n"
             "deeper than the radii have distances as exact and fast as bodies apart.");
  bind_half_space(module);
}

}  // namespace hardbody::python
