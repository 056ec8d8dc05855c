#pragma once

#include "base/select.h"

#include <cmath>
#include <limits>

namespace ed::internal {

/// First root tau > 0 of g + gp tau - K tau^2 / 2 for g >= 0; infinite if there is none, 0 if a number is not one. Of
/// one parabola, or of one in each lane.
template <class Real>
[[gnu::always_inline]] inline Real first_root(Real g, Real gp, Real K) {
  using std::sqrt;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const Real discriminant = gp * gp + 2 * K * g;
  const Real root = sqrt(discriminant);
  const auto falls = gp < 0;
  const Real tau = select(falls, 2 * g, gp + root) / select(falls, root - gp, K);
  return select(discriminant >= 0, select(falls | (K > 0), tau, kNone), select(discriminant < 0, kNone, 0.0));
}

}  // namespace ed::internal
