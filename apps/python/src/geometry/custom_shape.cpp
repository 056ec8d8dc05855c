#include "geometry/custom_shape.h"

#include "base/arguments.h"
#include "base/arrays.h"
#include "base/gil.h"
#include "base/values.h"
#include "geometry/bind.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace hardbody::python {

/// Object with its methods, looked up once, and its radii.
struct PythonShape::Held {
  nb::object object;
  nb::object support;
  nb::object hessian;  ///< method of the object; None if it has none
  nb::object empty = nb::module_::import_("numpy").attr("empty");
  std::string name;
  double bounding_radius = 0;
  double inscribed_radius = 0;
  double min_curvature_radius = 0;
  bool has_volume = false;

  ~Held() {
    const GilAcquired gil;
    empty.reset();
    hessian.reset();
    support.reset();
    object.reset();
  }
};

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Relative difference between the height that a method returns and that of its point.
constexpr double kSameHeight = 1e-9;
/// Half the step, an angle, of differences of support points.
constexpr double kDifference = 1e-5;
/// Number of interrupts in one call after which the call is given up.
constexpr int kMostInterrupts = 5;

thread_local KeptInterrupt* kept_interrupt = nullptr;

/// Returns an attribute, or what it returns if it can be called; None if there is none.
nb::object property(nb::handle object, const char* name) {
  nb::object value = attribute(object, name);
  return PyCallable_Check(value.ptr()) != 0 ? value() : value;
}

double radius(nb::handle object, const std::string& shape, const char* name) {
  const nb::object value = property(object, name);
  const std::string full = shape + '.' + name;
  if (value.is_none()) {
    throw nb::type_error((full + " is missing; accepted: a number, or a method that returns one").c_str());
  }
  return number(value, full.c_str());
}

/// Returns a method; None if the object has none. Throws TypeError for another attribute of that name.
nb::object optional_method(nb::handle object, const std::string& shape, const char* name) {
  nb::object value = attribute(object, name);
  if (!value.is_none() && PyCallable_Check(value.ptr()) == 0)
    refuse_type(shape + '.' + name, value, "a method, or None");
  return value;
}

std::string class_name(nb::handle object) {
  return nb::cast<std::string>(object.type().attr("__name__"));
}

}  // namespace

KeptInterrupt::KeptInterrupt() : outer_(std::exchange(kept_interrupt, this)) {}

KeptInterrupt::~KeptInterrupt() {
  kept_interrupt = outer_;
}

PythonShape::PythonShape(nb::object object, std::string name, bool has_volume) {
  auto held = std::make_shared<Held>();
  held->support = attribute(object, "support");
  if (PyCallable_Check(held->support.ptr()) == 0) {
    refuse_type(name, object, "an object with a method support(n)");
  }
  held->hessian = optional_method(object, name, "support_hessian");
  static_cast<void>(optional_method(object, name, "inertia"));
  held->bounding_radius = radius(object, name, "bounding_radius");
  held->inscribed_radius = radius(object, name, "inscribed_radius");
  if (!attribute(object, "min_curvature_radius").is_none()) {
    held->min_curvature_radius = radius(object, name, "min_curvature_radius");
  }
  held->object = std::move(object);
  held->name = std::move(name);
  held->has_volume = has_volume;
  held_ = std::move(held);
}

namespace {

/// Calls a method; after Ctrl-C once more if that is kept for later.
template <class Call>
auto without_interrupts(bool* happened, Call call) {
  for (int tries = 1;; ++tries) {
    try {
      return call();
    } catch (nb::python_error& error) {
      if (happened == nullptr || tries == kMostInterrupts || !error.matches(PyExc_KeyboardInterrupt)) throw;
      *happened = true;
    }
  }
}

/// Returns a direction as a new array.
nb::object direction_array(const nb::object& empty, const Vector3d& n) {
  nb::object array = empty(3);
  Vector3d::Map(nb::cast<nb::ndarray<double, nb::shape<3>, nb::c_contig>>(array).data()) = n;
  return array;
}

/// Reads a pair of a float and an array of three, as most shapes return them; false for anything else.
bool plain_support(nb::handle answer, geom::Support& out) {
  if (!PyTuple_Check(answer.ptr()) || PyTuple_Size(answer.ptr()) != 2) return false;
  const nb::handle height = PyTuple_GetItem(answer.ptr(), 0);
  if (!PyFloat_Check(height.ptr())) return false;
  nb::ndarray<const double, nb::shape<3>, nb::c_contig, nb::device::cpu> point;
  if (!nb::try_cast(nb::handle(PyTuple_GetItem(answer.ptr(), 1)), point, false)) return false;
  out = {PyFloat_AsDouble(height.ptr()), Vector3d::Map(point.data())};
  return true;
}

geom::Support read_support(nb::handle answer, const std::string& name) {
  if (!nb::isinstance<nb::tuple>(answer) || nb::len(answer) != 2) {
    constexpr const char* kSupportAnswer = "a tuple of the height and the point";
    if (!nb::isinstance<nb::tuple>(answer)) refuse_type(name, answer, kSupportAnswer);
    throw nb::type_error(
        (name + " has " + std::to_string(nb::len(answer)) + " entries; accepted: " + kSupportAnswer).c_str());
  }
  return {number(answer[0], (name + "[0]").c_str()), vector3(answer[1], (name + "[1]").c_str())};
}

/// Returns an answer of support(n). Throws TypeError or ValueError if it is none.
geom::Support checked_support(nb::handle answer, const std::string& shape, double R, const Vector3d& n) {
  const auto name = [&] { return shape + ".support(" + shown(n) + ')'; };
  geom::Support support{0, Vector3d::Zero()};
  if (!plain_support(answer, support)) support = read_support(answer, name());
  const double height = n.dot(support.point);
  if (!(std::abs(height - support.height) <= kSameHeight * R * n.norm())) {
    refuse_value(name(), '(' + shown(support.height) + ", " + shown(support.point) + ')',
                 "a finite height and a point of that height, here " + shown(height));
  }
  return support;
}

Matrix3d asked_hessian(const nb::object& method, const std::string& shape, const Vector3d& n) {
  const std::string name = shape + ".support_hessian(" + shown(n) + ')';
  const RealArray array(method(array_of(n)), name, "real numbers of shape (3, 3)");
  if (array.shape() != std::vector<std::size_t>{3, 3}) refuse_shape(name, array.shape(), "shape (3, 3)");
  const Matrix3d H = RowMajor3::Map(array.data());
  if (!H.allFinite()) refuse_value(name, "not finite", "finite numbers");
  return H;
}

}  // namespace

geom::Support PythonShape::support(const Vector3d& n) const {
  // Such a direction comes from numbers that have overflowed, as from a wrong Hessian: there will be no answer.
  if (!n.allFinite())
    return {std::numeric_limits<double>::quiet_NaN(), Vector3d::Constant(std::numeric_limits<double>::quiet_NaN())};
  const GilAcquired gil;
  bool* const happened = kept_interrupt == nullptr ? nullptr : &kept_interrupt->happened_;
  return without_interrupts(happened, [&] {
    const nb::object answer = held_->support(direction_array(held_->empty, n));
    return checked_support(answer, held_->name, held_->bounding_radius, n);
  });
}

Matrix3d PythonShape::support_hessian(const Vector3d& n) const {
  if (!n.allFinite()) return Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const GilAcquired gil;
  if (!held_->hessian.is_none()) {
    bool* const happened = kept_interrupt == nullptr ? nullptr : &kept_interrupt->happened_;
    return without_interrupts(happened, [&] { return asked_hessian(held_->hessian, held_->name, n); });
  }
  const double length = n.norm();
  const Vector3d m = n / length;
  const Vector3d t = m.cross(Vector3d::Unit(std::abs(m.x()) < 0.5 ? 0 : 1)).normalized();
  Matrix3d H = Matrix3d::Zero();
  for (const Vector3d& along : {t, Vector3d(m.cross(t))}) {
    const Vector3d step = kDifference * along;
    const Vector3d change = support(m + step).point - support(m - step).point;
    H += change / (2 * kDifference * length) * along.transpose();
  }
  return 0.5 * (H + H.transpose());
}

double PythonShape::bounding_radius() const {
  return held_->bounding_radius;
}
double PythonShape::inscribed_radius() const {
  return held_->inscribed_radius;
}
double PythonShape::min_curvature_radius() const {
  return held_->min_curvature_radius;
}
nb::object PythonShape::object() const {
  return held_->object;
}
bool PythonShape::has_volume() const {
  return held_->has_volume;
}

const PythonShape* python_shape(const ed::BodyShape& shape) {
  const auto* custom = std::get_if<ed::CustomShape>(&shape);
  return custom == nullptr ? nullptr : custom->target<PythonShape>();
}

bool is_custom_shape(nb::handle value) {
  return !PyType_Check(value.ptr()) && has_attribute(value, "support");
}

namespace {

/// Returns a property given by the caller or, if that is None, by the object; None if by neither.
nb::object given_or_own(nb::handle given, nb::handle object, const char* name) {
  return given.is_none() ? property(object, name) : nb::borrow(given);
}

ed::CustomShape make_custom_shape(nb::handle object, nb::handle name, nb::handle volume, nb::handle symmetry_axis,
                                  nb::handle centrally_symmetric) {
  if (PyType_Check(object.ptr())) {
    const auto type = nb::cast<std::string>(object.attr("__name__"));
    throw nb::type_error(("object is the class " + type + "; accepted: an object of it, " + type + "(...)").c_str());
  }
  ed::CustomShape::Properties properties;
  properties.name = name.is_none() ? class_name(object) : std::string(text(name, "name", "a string without NUL"));
  const auto full_name = [&](nb::handle given, const char* own) {
    return given.is_none() ? properties.name + '.' + own : own;
  };
  const nb::object volume_value = given_or_own(volume, object, "volume");
  const nb::object axis = given_or_own(symmetry_axis, object, "symmetry_axis");
  if (!axis.is_none()) {
    const std::string of = full_name(symmetry_axis, "symmetry_axis");
    properties.symmetry_axis = static_cast<int>(integer(axis, of.c_str(), 0, 2));
  }
  const nb::object central = given_or_own(centrally_symmetric, object, "centrally_symmetric");
  if (!central.is_none()) {
    const std::string of = full_name(centrally_symmetric, "centrally_symmetric");
    if (!PyBool_Check(central.ptr())) refuse_type(of, central, "True, False, None");
    properties.centrally_symmetric = nb::cast<bool>(central);
  }
  const bool has_volume = !volume_value.is_none();
  PythonShape shape(nb::borrow(object), properties.name, has_volume);
  // Without a volume one that the radii allow: nobody is shown it.
  const double r = shape.inscribed_radius();
  properties.volume =
      has_volume ? positive(volume_value, full_name(volume, "volume").c_str()) : 4 * std::numbers::pi / 3 * r * r * r;
  return {std::move(shape), std::move(properties)};
}

const PythonShape& target_of(const ed::CustomShape& shape) {
  return *shape.target<PythonShape>();  // there are no others in Python
}

/// Returns what the constructor is told beside the object.
nb::dict properties_of(const ed::CustomShape& shape) {
  nb::dict made;
  made["name"] = shape.name();
  made["volume"] = target_of(shape).has_volume() ? std::optional(shape.volume()) : std::optional<double>();
  made["symmetry_axis"] = shape.symmetry_axis();
  made["centrally_symmetric"] = shape.centrally_symmetric();
  return made;
}

/// Returns what pickles and copies are made of: the user's object has to be one that can be pickled.
nb::tuple reduced(nb::handle self) {
  const auto& shape = nb::cast<const ed::CustomShape&>(self);
  const nb::object constructor = nb::module_::import_("functools").attr("partial")(self.type(), **properties_of(shape));
  return nb::make_tuple(constructor, nb::make_tuple(target_of(shape).object()));
}

constexpr const char* kShapeDoc =
    "Convex body of your own: an object with a support function.\n"
    "\n"
    "Queries of one body or of a pair, Scene.add and Species also take the object itself; lists of shapes do not. It\n"
    "has, in the body's frame, whose origin is inside and is the centre of mass:\n"
    "\n"
    "support(n)\n"
    "    Returns (h, s) for a direction n, an array of shape (3,), of any length but 0: the height h = max of n.x "
    "over\n"
    "    the body, and the point s, three numbers, where it is reached, so that h = n.s.\n"
    "bounding_radius, inscribed_radius\n"
    "    Radii of spheres about the origin around and inside the body: numbers or methods. Contacts are certified "
    "from\n"
    "    these and the heights alone; a bounding radius that is too small or an inscribed one that is too large voids\n"
    "    the certificate.\n"
    "support_hessian(n)\n"
    "    Optional: second derivatives of h, shape (3, 3). Without it they are differences of support points, four "
    "calls.\n"
    "min_curvature_radius\n"
    "    Optional: radius of a ball that rolls inside the body all along its surface. Bodies with edges or kinks need\n"
    "    one, be it small: take the body smaller by r all around, and add r |n| to its height and r n/|n| to its "
    "point.\n"
    "volume, symmetry_axis, centrally_symmetric, inertia(mass)\n"
    "    Optional, as the arguments below. Dynamics needs the volume, and moments of inertia: a method inertia(mass), "
    "or\n"
    "    Species(shape, inertia=...).\n"
    "\n"
    "Exceptions of these methods end the call in which they happen and are raised by it.\n"
    "\n"
    "Speed: a call from C++ into Python and back takes a few microseconds, and each distance some tens of them: a\n"
    "simulation is some hundred times as slow as one of built-in shapes (docs/python-shapes.md). Write such bodies in\n"
    "C++ for anything long.";

}  // namespace

ed::CustomShape custom_shape_of(nb::handle object) {
  ed::CustomShape* made = nullptr;
  if (nb::try_cast(object, made, false) && made != nullptr) return *made;
  const nb::object none = nb::none();
  return make_custom_shape(object, none, none, none, none);
}

void bind_custom_shapes(nb::module_& module) {
  using ed::CustomShape;
  nb::class_<CustomShape> type(module, "CustomShape", nb::is_weak_referenceable(), kShapeDoc);
  type.def(
          "__init__",
          [](CustomShape* self, nb::handle object, nb::handle name, nb::handle volume, nb::handle symmetry_axis,
             nb::handle centrally_symmetric) {
            new (self) CustomShape(make_custom_shape(object, name, volume, symmetry_axis, centrally_symmetric));
          },
          nb::arg("object").none(), nb::kw_only(), nb::arg("name") = nb::none(), nb::arg("volume") = nb::none(),
          nb::arg("symmetry_axis") = nb::none(), nb::arg("centrally_symmetric") = nb::none(),
          nb::sig("def __init__(self, object: hardbody.SupportShape, *, name: str | None = None, "
                  "volume: float | None = None, symmetry_axis: int | None = None, "
                  "centrally_symmetric: bool | None = None) -> None"),
          "Constructs a shape from an object with a support function. None: the attribute or method of that name of\n"
          "the object, if there is one; as name, that of its class.\n"
          "\n"
          "symmetry_axis: body axis (0, 1, 2) about which the body is one of revolution: contacts then never change\n"
          "the spin about it. centrally_symmetric: -x is in the body for every x in it.\n"
          "\n"
          "Raises ValueError if heights in some 40 directions, radii, volume and symmetries contradict each other.")
      .def_prop_ro(
          "object", [](const CustomShape& s) { return target_of(s).object(); }, "Object given.")
      .def_prop_ro(
          "name", [](const CustomShape& s) { return s.name(); }, "Name in messages.")
      .def_prop_ro(
          "bounding_radius", [](const CustomShape& s) { return s.bounding_radius(); },
          "Radius of a sphere about the origin that contains the body.")
      .def_prop_ro(
          "inscribed_radius", [](const CustomShape& s) { return s.inscribed_radius(); },
          "Radius of a sphere about the origin that the body contains.")
      .def_prop_ro(
          "min_curvature_radius", [](const CustomShape& s) { return s.min_curvature_radius(); },
          "Radius of a ball that rolls inside the body all along its surface; 0: none is known.")
      .def_prop_ro(
          "volume",
          [](const CustomShape& s) {
            return target_of(s).has_volume() ? std::optional(s.volume()) : std::optional<double>();
          },
          "Volume, in units of length^3; None: not given.")
      .def_prop_ro(
          "symmetry_axis", [](const CustomShape& s) { return s.symmetry_axis(); },
          "Index (0, 1, 2) of the body's axis of revolution; None: not given.")
      .def(
          "support",
          [](const CustomShape& s, nb::handle n) {
            const geom::Support support = s.support(direction3(n, "n"));
            return nb::make_tuple(support.height, array_of(support.point));
          },
          nb::arg("n").none(),
          nb::sig("def support(self, n: numpy.typing.ArrayLike) -> tuple[float, numpy.typing.NDArray[numpy.float64]]"),
          "Returns the object's (h, s) for a direction n, shape (3,), checked.")
      .def("__repr__", [](const CustomShape& s) { return "CustomShape(" + s.name() + ')'; })
      .def("__reduce__", &reduced, nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
  bind_equality(type, [](const CustomShape& a, const CustomShape& b) {
    return target_of(a).object().equal(target_of(b).object()) && properties_of(a).equal(properties_of(b));
  });
}

}  // namespace hardbody::python
