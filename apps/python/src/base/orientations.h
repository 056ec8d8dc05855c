#pragma once

/// Orientations of many bodies as arguments of Python functions.

#include "base/arrays.h"

#include <geom/pose.h>

#include <nanobind/nanobind.h>

#include <Eigen/Core>

#include <cstddef>
#include <string>

namespace hardbody::python {

/// Returns whether a value is a rotation, or an array of them, as of scipy.spatial.transform.Rotation.
bool is_scipy_rotation(nb::handle value);

/// Orientations of bodies: quaternions (w, x, y, z) of shape (N, 4), rotation matrices of shape (N, 3, 3), or SciPy's
/// rotations, which are read as matrices, so that the order of their quaternions does not matter.
class Orientations {
 public:
  /// Reads an argument. Throws as RealArray, and ValueError for another shape; empty sequences are no rows.
  Orientations(nb::handle value, const std::string& name);

  std::size_t size() const { return rows_; }
  bool are_matrices() const { return columns_ == 9; }

  /// Returns the numbers of a body: w, x, y, z, or the matrix row by row.
  const double* operator[](std::size_t body) const { return array_.data() + body * columns_; }

  /// Returns a body's pose by Pose's own functions. Throws std::invalid_argument if the numbers are refused.
  geom::Pose pose(std::size_t body, const Eigen::Vector3d& position = Eigen::Vector3d::Zero()) const;

  /// Returns a body's matrix, if the orientations are matrices.
  Eigen::Matrix3d matrix(std::size_t body) const;

 private:
  RealArray array_;
  std::size_t columns_;
  std::size_t rows_;
};

}  // namespace hardbody::python
