#include "base/orientations.h"

#include <vector>

namespace hardbody::python {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr const char* kAccepted =
    "quaternions (w, x, y, z) of shape (N, 4), rotation matrices of shape (N, 3, 3), or an array of N rotations of "
    "scipy.spatial.transform.Rotation";

nb::object numbers_of(nb::handle value) {
  return is_scipy_rotation(value) ? nb::object(value.attr("as_matrix")()) : nb::borrow(value);
}

/// Returns the number of numbers of a body. Throws ValueError, naming the shape, unless the array is of orientations.
std::size_t columns_of(const std::vector<std::size_t>& shape, const std::string& name) {
  if (shape.size() == 3 && shape[1] == 3 && shape[2] == 3) return 9;
  if ((shape.size() == 2 && shape[1] == 4) || shape == std::vector<std::size_t>{0}) return 4;
  refuse_shape(name, shape, kAccepted);
}

}  // namespace

bool is_scipy_rotation(nb::handle value) {
  return nb::hasattr(value, "as_matrix") && nb::hasattr(value, "as_quat");
}

Orientations::Orientations(nb::handle value, const std::string& name)
    : array_(numbers_of(value), name, kAccepted),
      columns_(columns_of(array_.shape(), name)),
      rows_(array_.shape()[0]) {}

geom::Pose Orientations::pose(std::size_t body, const Eigen::Vector3d& position) const {
  if (are_matrices()) return {matrix(body), position};
  const double* const q = (*this)[body];
  return geom::Pose::from_quaternion(q[0], q[1], q[2], q[3], position);
}

Eigen::Matrix3d Orientations::matrix(std::size_t body) const {
  return RowMajor3::Map((*this)[body]);
}

}  // namespace hardbody::python
