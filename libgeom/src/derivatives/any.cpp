#include "batch/checks.h"

#include <geom/derivatives.h>
#include <geom/kernel/any_body.h>
#include <geom/kernel/refuse.h>

#include <cstddef>
#include <span>
#include <string>

namespace geom {

DistanceDerivatives distance_derivatives(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                         const DistanceResult& at) {
  const kernel::ContactBody in_a = kernel::contact_body(a, X_WA);
  const kernel::ContactBody in_b = kernel::contact_body(b, X_WB);
  const kernel::RivalTrial trial = kernel::rival_trial(in_a, in_b, at);
  bool single = true;
  if (trial.needed) {
    const Pose moved = kernel::moved(X_WB, trial.by);
    single = kernel::confirms(trial, at, distance(a, X_WA, b, moved));
  }
  return kernel::contact_derivatives(in_a, in_b, at, single);
}

DistanceDerivatives distance_derivatives(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                         const DistanceOptions& options, DistanceResult* at) {
  const DistanceResult found = distance(a, X_WA, b, X_WB, options);
  if (at != nullptr) *at = found;
  return distance_derivatives(a, X_WA, b, X_WB, found);
}

std::size_t distance_derivatives_batch(std::span<const Shape> a, std::span<const Pose> X_WA, std::span<const Shape> b,
                                       std::span<const Pose> X_WB, std::span<const DistanceResult> at,
                                       std::span<DistanceDerivatives> results) {
  const std::size_t pairs = results.size();
  const kernel::Input<Shape> in_a = kernel::checked("a", a, pairs), in_b = kernel::checked("b", b, pairs);
  const kernel::Input<Pose> in_X_WA = kernel::checked("X_WA", X_WA, pairs);
  const kernel::Input<Pose> in_X_WB = kernel::checked("X_WB", X_WB, pairs);
  if (at.size() != pairs) {
    kernel::refuse("distance_derivatives_batch: at has " + std::to_string(at.size()) +
                   " elements; accepted: the number of results, " + std::to_string(pairs));
  }
  std::size_t twice = 0;
  for (std::size_t k = 0; k < pairs; ++k) {
    results[k] = distance_derivatives(in_a[k], in_X_WA[k], in_b[k], in_X_WB[k], at[k]);
    if (results[k].twice()) ++twice;
  }
  return twice;
}

}  // namespace geom
