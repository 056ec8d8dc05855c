#pragma once

/// Assertions on a DistanceResult that every test of `distance` makes.

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>

namespace geom_test {

inline bool all_nan(const Eigen::Vector3d& v) {
  return std::isnan(v.x()) && std::isnan(v.y()) && std::isnan(v.z());
}

/// Checks that a declined result contains no number that could be mistaken for an answer.
inline testing::AssertionResult declined(const geom::DistanceResult& r) {
  if (r.status != geom::DistanceStatus::not_converged && r.status != geom::DistanceStatus::singular) {
    return testing::AssertionFailure() << "status " << to_string(r.status) << ", distance " << r.distance;
  }
  if (!std::isnan(r.distance) || !all_nan(r.point_a) || !all_nan(r.point_b) || !all_nan(r.normal) ||
      !std::isnan(r.residual)) {
    return testing::AssertionFailure() << "declined, but not every number is NaN; distance " << r.distance;
  }
  return testing::AssertionSuccess();
}

/// Checks that the answer is `distance` within `tolerance`, that its status is the sign of it, and that its parts agree
/// with each other.
///
/// `extent`: a bound of the coordinates that occur; identities hold to a few roundings of it.
inline testing::AssertionResult answers(const geom::DistanceResult& r, double distance, double tolerance,
                                        double extent) {
  using geom::DistanceStatus;
  if (r.status != (r.distance >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping)) {
    return testing::AssertionFailure() << "status " << to_string(r.status) << ", distance " << r.distance;
  }
  if (!(std::abs(r.distance - distance) <= tolerance)) {
    return testing::AssertionFailure() << "distance " << r.distance << ", wanted " << distance << ", error "
                                       << r.distance - distance << ", tolerance " << tolerance;
  }
  // The contract's 1e-13 for a vector of length `distance`.
  if (!(std::abs(r.normal.norm() - 1) <= 1e-13)) {
    return testing::AssertionFailure() << "normal not unit: " << r.normal.norm() - 1;
  }
  // One rounding of each of the two points and of the product.
  const double identity = (r.point_b - r.point_a - r.distance * r.normal).norm();
  if (!(identity <= 1e-15 * extent)) {
    return testing::AssertionFailure() << "point_b - point_a is not distance * normal: " << identity;
  }
  if (!(r.residual >= 0) || r.iterations < 1) {
    return testing::AssertionFailure() << "residual " << r.residual << ", iterations " << r.iterations;
  }
  return testing::AssertionSuccess();
}

}  // namespace geom_test
