#pragma once

/// @file
/// Compile-time check that Eigen is configured to lay out vectors and matrices as the libraries were compiled for.
/// Every public header of libgeom and libed that uses Eigen includes this one.
///
/// The libraries exchange only `Vector3d`, `Matrix3d` and matrices with Eigen::DontAlign with a program. No value of
/// -march, EIGEN_MAX_ALIGN_BYTES, EIGEN_MAX_STATIC_ALIGN_BYTES or EIGEN_DONT_ALIGN changes those, since the sizes of
/// the first two are not multiples of 16 bytes; EIGEN_DEFAULT_TO_ROW_MAJOR transposes every matrix, and plugins can add
/// members.

#include <Eigen/Core>

#ifdef EIGEN_DEFAULT_TO_ROW_MAJOR
#error \
    "hardbody: EIGEN_DEFAULT_TO_ROW_MAJOR is defined, with which rotations would be read transposed; \
accepted: Eigen's default, column-major. Declare row-major matrices of your own as Eigen::Matrix<double, 3, 3, Eigen::RowMajor>"
#endif

namespace geom::kernel {

// The macro may have been defined for the first inclusion of Eigen only.
static_assert(!Eigen::Matrix3d::IsRowMajor,
              "hardbody: Eigen::Matrix3d is row-major (EIGEN_DEFAULT_TO_ROW_MAJOR), with which rotations would be read "
              "transposed; accepted: Eigen's default, column-major");
static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double) && alignof(Eigen::Vector3d) == alignof(double) &&
                  sizeof(Eigen::Matrix3d) == 9 * sizeof(double) && alignof(Eigen::Matrix3d) == alignof(double),
              "hardbody: Eigen::Vector3d or Eigen::Matrix3d is not laid out as in the libraries (EIGEN_MATRIX_PLUGIN, "
              "EIGEN_DENSEBASE_PLUGIN ...); accepted: 3 and 9 doubles and nothing else");

}  // namespace geom::kernel
