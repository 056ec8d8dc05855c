#pragma once

/// Formulas of DilatedEnvelopes for one pair, or for one in each lane of a vector.

#include <cmath>

namespace ed::internal {

/// Largest number of Newton steps after the first evaluation; a pair that is still undecided is taken, which is always
/// safe.
inline constexpr int kOverlapSteps = 2;

/// Whether the gap along the line of centres is above `limit`.
template <class Shape, class Vector, class Real>
[[gnu::always_inline]] inline auto apart_along_centres(const Shape& A, const Shape& B, const Vector& u_a,
                                                       const Vector& u_b, const Vector& r, Real limit) {
  using std::sqrt;
  const Real r2 = r.squaredNorm();
  const Real distance = sqrt(r2);
  const Real r_a = u_a.dot(r);
  const Real r_b = u_b.dot(r);
  const Real h_a = sqrt(A.b2 * r2 + A.c * (r_a * r_a));
  const Real h_b = sqrt(B.b2 * r2 + B.c * (r_b * r_b));
  // Both sides times the distance; the share of 1e-9 covers the cancellation in h for discs.
  return r2 - h_a - h_b > limit * distance + 1e-9 * r2;
}

}  // namespace ed::internal
