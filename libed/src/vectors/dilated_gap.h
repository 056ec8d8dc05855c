#pragma once

/// Formulas of DilatedEnvelopes for one pair, or for one in each lane of a vector.

#include "base/select.h"
#include "contact/rods/pair.h"

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

/// Two rods in dilated envelopes.
template <class Real, class Vector>
struct RodEnvelopesOf {
  Real a, b;   ///< half-lengths
  Real balls;  ///< sum of the radii
  Vector r, u_a, u_b;

  /// Returns whether the gap along the line of centres is above `limit`.
  [[gnu::always_inline]] auto apart_along_centres(Real limit) const {
    using std::abs, std::sqrt;
    const Real r2 = r.squaredNorm();
    return r2 - (a * abs(u_a.dot(r)) + b * abs(u_b.dot(r))) > (balls + limit) * sqrt(r2);
  }

  /// Returns the normal along the closest points, that of A's axis if they coincide, and sets the gap along it.
  [[gnu::always_inline]] Vector normal(Real& gap) const {
    using std::abs, std::sqrt;
    const RodPointsOf<Real> at = closest_on_rods(a, b, r, u_a, u_b);
    const Vector between = r + (at.t * u_b - at.s * u_a);
    const Real length2 = between.squaredNorm();
    const auto apart = length2 > 0;
    const Real inverse = select(apart, 1 / sqrt(select(apart, length2, 1.0)), 0.0);
    Vector n = inverse * between + select(apart, 0.0, 1.0) * u_a;
    gap = (n.dot(r) - (a * abs(n.dot(u_a)) + b * abs(n.dot(u_b)))) - balls;
    return n;
  }
};

}  // namespace ed::internal
