#pragma once

/// Rate of the gap of two bodies of revolution along a fixed normal, and a bound of its change. One formula serves one
/// pair, or one in each lane of a vector.

#include "base/select.h"

#include <cmath>

namespace ed::internal {

/// Returns dg/dt at fixed n, centres moving at v, axes at du; lever = c x / h of both bodies.
template <class Vector, class Both>
[[gnu::always_inline]] inline auto gap_rate(const Vector& v, const Vector& du_a, const Vector& du_b, const Both& lever,
                                            const Vector& n) {
  return v.dot(n) - lever[0] * du_a.dot(n) - lever[1] * du_b.dot(n);
}

/// Error of the square of the amplitude r of x: 60 units of 2^-53, more than the errors of x and of its rate make of
/// it.
inline constexpr double kAmplitudeRounding = 7e-15;

/// An upper bound over tau' in [0, tau] of d2h/dt2, h = h(n, u(t + tau')) the support function of one body at fixed n.
///
/// With x = n.u, C = n.e0 and c = a^2 - b^2 the axis moves so that xdd = -Omega^2 (x - C), and
///
///     h'' = (c Omega^2 / h) [b^2 (r^2 - (x-C)^2) / h^2 - x (x-C)],   r^2 = (x-C)^2 + xd^2 / Omega^2,
///
/// h^2 = b^2 + c x^2. |xdd| <= Omega^2 r bounds the reach of x over tau; the bracket is then taken at its worst end.
template <bool kSpin, class Real = double>
struct SupportCurvature {
  Real x;       ///< n.u
  Real xd;      ///< n.du/dt
  Real rate;    ///< Omega
  Real centre;  ///< C = n.e0; used with spin only

  template <class Shape>
  Real bound(const Shape& S, Real tau) const {
    if constexpr (kSpin) {
      return bound_spinning(S, tau);
    } else {
      return bound_across(S, tau);
    }
  }

 private:
  /// Returns the bound for bodies without spin. Then C = 0 and h'' depends on s = x^2 alone: falling in s for a rod (c
  /// > 0), rising for a disc.
  template <class Shape>
  Real bound_across(const Shape& S, Real tau) const {
    using std::abs, std::copysign, std::sqrt;
    const Real rate2 = rate * rate;
    const Real r2 = smaller(1.0, x * x + xd * xd / (rate2 + 1e-300));
    const Real r = sqrt(r2);
    const Real magnitude = abs(x);
    const Real outward = copysign(1.0, x) * xd;  // d|x|/dt; at x = 0 either sign is covered below
    // |x| after tau under the strongest pull towards (and beyond) zero; negative: it may have passed zero.
    const Real end = magnitude + tau * (outward - 0.5 * rate2 * r * tau);
    const Real low = larger(0.0, smaller(magnitude, end));
    const Real s_low = low * low;
    const Real h2_low = S.b2 + S.c * s_low;
    const Real h3_low = h2_low * sqrt(h2_low);
    const auto rod = S.c > 0;
    const Real of_rod = S.c * rate2 * (S.b2 * (r2 - s_low) - s_low * h2_low) / h3_low;
    if (all(rod)) return of_rod;
    const Real high = smaller(r, larger(magnitude + larger(0.0, outward) * tau, -end));
    const Real s_high = high * high;
    const Real h_high = sqrt(larger(S.a2, S.b2 + S.c * s_high));
    return select(rod, of_rod, -S.c * rate2 * (s_high / h_high - S.b2 * (r2 - s_high) / h3_low));
  }

  /// Returns the bound for bodies that spin. Each factor is taken at its own worst end over the reach [low, high] of x.
  template <class Shape>
  Real bound_spinning(const Shape& S, Real tau) const {
    using std::sqrt;
    const Real rate2 = rate * rate;
    const Real offset = x - centre;
    const Real r2 = offset * offset + xd * xd / (rate2 + 1e-300);
    // r is rounded by more than its own errors: what it multiplies may be large.
    const Real r = sqrt(r2 + kAmplitudeRounding);
    const Real swing = 0.5 * rate2 * r * tau * tau;
    const Real low = larger(centre - r, x + smaller(0.0, xd) * tau - swing);
    const Real high = smaller(centre + r, x + larger(0.0, xd) * tau + swing);
    const Real low_offset = low - centre;
    const Real high_offset = high - centre;
    const Real at_low = low * low_offset;
    const Real at_high = high * high_offset;
    const Range x2 = squares(low, high);
    const Range offset2 = squares(low_offset, high_offset);
    const Real h2_inner = S.b2 + S.c * x2.least;
    const Real h2_outer = S.b2 + S.c * smaller(1.0, x2.most);
    const auto rod = S.c > 0;
    Real of_rod = 0.0;
    if (any(rod)) {
      const Real h_min = sqrt(h2_inner);
      const Real middle = 0.5 * centre;  // where x (x - C) is least
      const Real product = select((low <= middle) & (middle <= high), -middle * middle, smaller(at_low, at_high));
      const Real pull = -product;
      const Real h_pull = select(pull > 0, h_min, sqrt(h2_outer));
      of_rod = S.c * rate2 * (S.b2 * larger(0.0, r2 - offset2.least) / (h2_inner * h_min) + pull / h_pull);
      if (all(rod)) return of_rod;
    }
    // h of a disc is least where |x| is greatest, h of a rod where it is least.
    const Real h_min = sqrt(larger(S.a2, h2_outer));
    const Real h_max = sqrt(h2_inner);
    const Real product = larger(at_low, at_high);
    return select(
        rod, of_rod,
        -S.c * rate2 *
            (product / select(product > 0, h_min, h_max) - S.b2 * larger(0.0, r2 - offset2.most) / (h2_inner * h_max)));
  }

  struct Range {
    Real least, most;
  };
  /// Returns the range of y^2 over [low, high].
  static Range squares(Real low, Real high) {
    const Real low2 = low * low;
    const Real high2 = high * high;
    return {select(low * high <= 0, 0.0, smaller(low2, high2)), larger(low2, high2)};
  }
};

}  // namespace ed::internal
