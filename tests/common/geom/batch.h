#pragma once

/// Common parts of the tests of distance_batch: the instruction sets to test, and the comparison with `distance`.

#include "common/geom/expect.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <vector>

namespace geom_test {

/// Returns the instruction sets of this processor.
inline std::vector<geom::InstructionSet> instruction_sets() {
  std::vector<geom::InstructionSet> sets;
  for (const auto set : {geom::InstructionSet::portable, geom::InstructionSet::avx2, geom::InstructionSet::avx512}) {
    if (geom::is_available(set)) sets.push_back(set);
  }
  return sets;
}

/// Pairs in the form that distance_batch takes.
struct Pairs {
  std::vector<geom::Ellipsoid> a;
  std::vector<geom::Pose> X_WA;
  std::vector<geom::Ellipsoid> b;
  std::vector<geom::Pose> X_WB;

  void add(const geom::Ellipsoid& shape_a, const geom::Pose& pose_a, const geom::Ellipsoid& shape_b,
           const geom::Pose& pose_b) {
    a.push_back(shape_a);
    X_WA.push_back(pose_a);
    b.push_back(shape_b);
    X_WB.push_back(pose_b);
  }
  std::size_t size() const { return a.size(); }
  Eigen::Vector3d p_AB(std::size_t i) const { return X_WB[i].position() - X_WA[i].position(); }
  double radii(std::size_t i) const { return a[i].bounding_radius() + b[i].bounding_radius(); }
  /// Returns the length that errors are relative to.
  double scale(std::size_t i) const { return p_AB(i).norm() + radii(i); }
  /// Returns a bound of the coordinates that occur.
  double extent(std::size_t i) const { return X_WA[i].position().norm() + 2 * scale(i); }

  geom::DistanceResult distance(std::size_t i, const geom::DistanceOptions& options = {}) const {
    return geom::distance(a[i], X_WA[i], b[i], X_WB[i], options);
  }
  std::vector<geom::DistanceResult> distance_batch(const geom::BatchOptions& options = {}) const {
    std::vector<geom::DistanceResult> results(size());
    geom::distance_batch(a, X_WA, b, X_WB, results, options);
    return results;
  }
};

/// Checks the contract of batch.h: within 1e-14 of the size, and the same status unless the bodies touch to that
/// accuracy.
inline testing::AssertionResult same_answer(const geom::DistanceResult& batch, const geom::DistanceResult& scalar,
                                            double scale, double extent) {
  using geom::DistanceStatus;
  if (scalar.status != DistanceStatus::separated && scalar.status != DistanceStatus::overlapping) {
    return declined(batch);
  }
  const double tolerance = 1e-14 * scale;
  if (batch.status != scalar.status && !(std::abs(scalar.distance) <= tolerance)) {
    return testing::AssertionFailure() << "status " << to_string(batch.status) << ", of distance "
                                       << to_string(scalar.status);
  }
  // The kernels answer if the certificate is as tight as rounding, and else leave the pair to `distance`.
  if (!(batch.error_bound >= 0 && batch.error_bound <= std::max(scalar.error_bound, 1.01e-15 * scale))) {
    return testing::AssertionFailure() << "error bound " << batch.error_bound << ", of distance " << scalar.error_bound;
  }
  return answers(batch, scalar.distance, tolerance, extent);
}

}  // namespace geom_test
