#include "base/arguments.h"
#include "base/arrays.h"
#include "base/orientations.h"
#include "base/values.h"
#include "geometry/bind.h"

#include <geom/pose.h>
#include <geom/tolerances.h>

#include <nanobind/nanobind.h>

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace hardbody::python {
namespace {

using geom::Pose;
using Shape = std::vector<std::size_t>;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using RowMajor4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

constexpr const char* kOrientations =
    "a quaternion (w, x, y, z), a rotation matrix of shape (3, 3), or one rotation of scipy.spatial.transform.Rotation";

/// Reads a matrix of shape (n, n).
template <class Matrix>
Matrix matrix(nb::handle value, const char* name) {
  constexpr std::size_t n = Matrix::RowsAtCompileTime;
  const std::string accepted = "real numbers of shape (" + std::to_string(n) + ", " + std::to_string(n) + ')';
  const RealArray array(value, name, accepted);
  if (array.shape() != Shape{n, n}) refuse_shape(name, array.shape(), accepted);
  return Matrix::Map(array.data());
}

Pose pose_of(nb::handle position, nb::handle orientation) {
  const Eigen::Vector3d p = position.is_none() ? Eigen::Vector3d::Zero() : vector3(position, "position");
  if (orientation.is_none()) return Pose::translation(p);
  std::array<double, 4> q{};
  if (plain_numbers(orientation, q.data(), 4)) return Pose::from_quaternion(q[0], q[1], q[2], q[3], p);
  if (is_scipy_rotation(orientation)) return {matrix<RowMajor3>(orientation.attr("as_matrix")(), "orientation"), p};
  const RealArray array(orientation, "orientation", kOrientations);
  const double* const x = array.data();
  if (array.shape() == Shape{4}) return Pose::from_quaternion(x[0], x[1], x[2], x[3], p);
  if (array.shape() == Shape{3, 3}) return {RowMajor3::Map(x), p};
  refuse_shape("orientation", array.shape(), kOrientations);
}

/// Reads a homogeneous matrix: its rotation and position.
RowMajor4 homogeneous(nb::handle value) {
  const RowMajor4 X = matrix<RowMajor4>(value, "matrix");
  const Eigen::RowVector4d last = X.row(3);
  if (!((last - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= geom::kPoseTolerance)) {
    refuse_value("matrix[3]", shown(last.data(), 4), "[0, 0, 0, 1] within 1e-6");
  }
  return X;
}

std::array<double, 4> quaternion_of(const Pose& pose) {
  return geom::kernel::quaternion_of(pose.rotation());
}

nb::object matrix_of(const Pose& pose) {
  const NewArray<double> made = new_array<double>({4, 4});
  RowMajor4::MapType X(made.data);
  X.setIdentity();
  X.topLeftCorner<3, 3>() = pose.rotation();
  X.topRightCorner<3, 1>() = pose.position();
  return made.array;
}

/// Maps points of shape (3,) or (n, 3); the result has the same shape.
template <class Map>
nb::object mapped(nb::handle points, Map map) {
  constexpr const char* kAccepted = "real numbers of shape (3,) or (n, 3)";
  const RealArray array(points, "points", kAccepted);
  const Shape& shape = array.shape();
  if (shape.empty() || shape.size() > 2 || shape.back() != 3) refuse_shape("points", shape, kAccepted);
  const NewArray<double> made = new_array<double>(shape);
  const std::size_t count = shape.size() == 1 ? 1 : shape[0];
  for (std::size_t k = 0; k < count; ++k) {
    Eigen::Vector3d::Map(made.data + 3 * k) = map(Eigen::Vector3d::Map(array.data() + 3 * k));
  }
  return made.array;
}

std::string pose_text(const Pose& pose) {
  return "Pose(" + shown(pose.position()) + ", " + shown(quaternion_of(pose).data(), 4) + ')';
}

/// Restores the same bits. Throws ValueError unless they are a pose's.
Pose restored_pose(nb::handle position, nb::handle rotation) {
  const Eigen::Matrix3d R = matrix<RowMajor3>(rotation, "rotation");
  const Pose checked(R, vector3(position, "position"));
  return geom::kernel::unchecked_pose(R, checked.position());
}

void bind_constructors(nb::class_<Pose>& type) {
  type.def(
          "__init__",
          [](Pose* self, nb::handle position, nb::handle orientation) {
            new (self) Pose(pose_of(position, orientation));
          },
          nb::arg("position") = nb::none(), nb::arg("orientation") = nb::none(),
          nb::sig("def __init__(self, position: numpy.typing.ArrayLike | None = None, "
                  "orientation: numpy.typing.ArrayLike | hardbody.RotationLike | None = None) -> None"),
          "Constructs a pose from a position, shape (3,), default the origin, and an orientation, default none: a\n"
          "unit quaternion (w, x, y, z), shape (4,); a rotation matrix, shape (3, 3), whose columns are the body's\n"
          "axes in the world; or one rotation of scipy.spatial.transform.Rotation.\n"
          "\n"
          "Raises ValueError unless all numbers are finite, no coordinate is beyond +-1e100, and the quaternion's\n"
          "norm is 1, or R^T R the identity, within 1e-6.")
      .def_static(
          "from_matrix",
          [](nb::handle value) {
            const RowMajor4 X = homogeneous(value);
            return Pose(X.topLeftCorner<3, 3>(), X.topRightCorner<3, 1>());
          },
          nb::arg("matrix").none(), nb::sig("def from_matrix(matrix: numpy.typing.ArrayLike) -> Pose"),
          "Returns the pose of a homogeneous matrix [[R, p], [0, 1]], shape (4, 4), body to world. Raises ValueError\n"
          "as the constructor does.")
      .def_static(
          "normalized",
          [](nb::handle position, nb::handle quaternion) {
            std::array<double, 4> q{};
            numbers(quaternion, "quaternion", q.data(), 4);
            return Pose::normalized_quaternion(q[0], q[1], q[2], q[3], vector3(position, "position"));
          },
          nb::arg("position").none(), nb::arg("quaternion").none(),
          nb::sig("def normalized(position: numpy.typing.ArrayLike, quaternion: numpy.typing.ArrayLike) -> Pose"),
          "Returns a pose with the orientation q / |q| of a quaternion (w, x, y, z) of any length but 0.")
      .def_static(
          "nearest",
          [](nb::handle value) {
            const RowMajor4 X = homogeneous(value);
            return Pose::nearest_rotation(X.topLeftCorner<3, 3>(), X.topRightCorner<3, 1>());
          },
          nb::arg("matrix").none(), nb::sig("def nearest(matrix: numpy.typing.ArrayLike) -> Pose"),
          "Returns the pose nearest to a homogeneous matrix, shape (4, 4), that has drifted: a product of many\n"
          "transforms, or of some in single precision. R^T R must be the identity within 1e-2.");
}

void bind_numbers(nb::class_<Pose>& type) {
  const auto array = [](const char* name) { return nb::for_getter(nb::sig(name)); };
  type.def_prop_ro(
          "position", [](const Pose& X) { return array_of(X.position()); },
          array("def position(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Position of the body's origin in the world, shape (3,).")
      .def_prop_ro(
          "quaternion", [](const Pose& X) { return array_of(quaternion_of(X)); },
          array("def quaternion(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Unit quaternion (w, x, y, z), body to world, w >= 0, shape (4,).")
      .def_prop_ro(
          "rotation", [](const Pose& X) { return array_of(X.rotation()); },
          array("def rotation(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Rotation matrix, shape (3, 3); its columns are the body's axes in the world.")
      .def_prop_ro(
          "matrix", [](const Pose& X) { return matrix_of(X); },
          array("def matrix(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Homogeneous matrix [[R, p], [0, 1]], body to world, shape (4, 4).");
}

/// Refuses arrays as operands, which would treat a pose as a number; lets Python try the operators of others.
nb::object refuse_array(const Pose& /*pose*/, nb::handle other) {
  if (nb::hasattr(other, "__array_interface__")) {
    refuse_type("other", other, "a Pose; Pose.apply transforms points, and Pose.matrix is an array");
  }
  return nb::borrow(nb::handle(Py_NotImplemented));
}

nb::object product(const Pose& X, nb::handle other) {
  Pose* found = nullptr;
  if (nb::try_cast(other, found, false) && found != nullptr) return nb::cast(X * *found);
  return refuse_array(X, other);
}

void bind_products(nb::class_<Pose>& type) {
  type.attr("__array_ufunc__") = nb::none();  // NumPy's operators then leave arrays times poses to those below
  type.def("__mul__", &product, nb::arg("other").none(), nb::sig("def __mul__(self, other: Pose, /) -> Pose"),
           "Composes X_WB * X_BC = X_WC: (X_WB * X_BC).apply(p) = X_WB.apply(X_BC.apply(p)).")
      .def("__matmul__", &product, nb::arg("other").none(), nb::sig("def __matmul__(self, other: Pose, /) -> Pose"),
           "Composes, as * does.")
      .def("__rmul__", &refuse_array, nb::arg("other").none(),
           nb::sig("def __rmul__(self, other: typing.Never, /) -> typing.NoReturn"))
      .def("__rmatmul__", &refuse_array, nb::arg("other").none(),
           nb::sig("def __rmatmul__(self, other: typing.Never, /) -> typing.NoReturn"));
}

void bind_operations(nb::class_<Pose>& type) {
  type.def("inverse", &Pose::inverse, "Returns the pose of the world seen from the body.")
      .def(
          "apply",
          [](const Pose& X, nb::handle points) {
            return mapped(points, [&](const Eigen::Vector3d& p) { return X.to_world(p); });
          },
          nb::arg("points").none(),
          nb::sig("def apply(self, points: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]"),
          "Transforms points, shape (3,) or (n, 3), from body to world coordinates.")
      .def(
          "apply_inverse",
          [](const Pose& X, nb::handle points) {
            return mapped(points, [&](const Eigen::Vector3d& p) { return X.to_body(p); });
          },
          nb::arg("points").none(),
          nb::sig("def apply_inverse(self, points: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]"),
          "Transforms points, shape (3,) or (n, 3), from world to body coordinates.")
      .def("__repr__", &pose_text)
      .def(
          "__eq__",
          [](const Pose& X, nb::handle other) {
            Pose* found = nullptr;
            return nb::try_cast(other, found, false) && found != nullptr && X.rotation() == found->rotation() &&
                   X.position() == found->position();
          },
          nb::arg("other").none(), nb::sig("def __eq__(self, other: typing.Any, /) -> bool"))
      .def(
          "__getstate__", [](const Pose& X) { return nb::make_tuple(array_of(X.position()), array_of(X.rotation())); },
          nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__", [](Pose& X, const nb::tuple& state) { new (&X) Pose(restored_pose(state[0], state[1])); },
          nb::sig("def __setstate__(self, state: tuple[typing.Any, ...], /) -> None"));
}

}  // namespace

void bind_poses(nb::module_& module) {
  nb::class_<Pose> type(module, "Pose", nb::is_weak_referenceable(),
                        "Position and orientation of a body in the world: p_world = rotation @ p_body + position.");
  bind_constructors(type);
  bind_numbers(type);
  bind_operations(type);
  bind_products(type);
  bind_reduce(type);
  type.attr("__hash__") = nb::none();  // equal poses may differ in the sign of a zero
}

}  // namespace hardbody::python
