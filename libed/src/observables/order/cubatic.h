#pragma once

/// Cubatic order: how far three axes of each body are along three directions common to all.

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace ed::internal {

/// Returns max over n of <sum over the three body axes of P4(u.n)> / (7/4), bodies begin, begin + 1, .., end - 1: 1 for
/// bodies whose axes are parallel up to permutations, 0 in a large isotropic system. As P4 has the terms x^4, x^2 and
/// 1, and the squares of the three components of n add up to 1, this is 5/2 <sum (u.n)^4> - 3/2, a convex form of n,
/// which is maximised by power iterations from 13 directions.
double cubatic_order(const std::vector<Eigen::Matrix3d>& rotations, std::size_t begin, std::size_t end);

}  // namespace ed::internal
