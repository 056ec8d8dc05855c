#pragma once

#include <Eigen/Core>

namespace geom::kernel {

/// Returns the sign (-1, 0, 1) of ((b - a) x (c - a)).(p - a), exactly: 1 if p is on the outer side of a triangle that
/// is anticlockwise seen from outside. Coordinates are 0 or within [2^-200, 1] in magnitude.
int exact_side(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Eigen::Vector3d& p);

/// Returns (b - a) x (c - a), each component accurate to rounding however thin the triangle is. Coordinates as above.
Eigen::Vector3d accurate_normal(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace geom::kernel
