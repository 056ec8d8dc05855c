#pragma once

/// Certificates made of a gap, its rate and a bound of its curvature. One formula serves one pair, or one in each lane
/// of a vector, in the same order and with the same bits.

#include "base/select.h"
#include "contact/first_root.h"
#include "contact/rounding.h"

#include <ed/tolerances.h>

namespace ed::internal {

/// Whether there is no contact within the horizon: a concave parabola that is positive at both ends has no root
/// between. g, rate and limit (of the curvature) as computed; `hidden` is taken off.
template <class Real>
[[gnu::always_inline]] inline auto clear_by_parabola(Real g, Real rate, Real limit, const RoundingOf<Real>& hidden,
                                                     Real horizon) {
  const Real worst_turn = 0.5 * (limit + hidden.curvature) * horizon;
  const Real least_rate = rate - hidden.rate;
  return (g > hidden.gap) & ((g - hidden.gap) + horizon * (least_rate - worst_turn) > 0);
}

/// The longest of some steps, at most `horizon`, that root(reach) certifies: a step up to `reach`. A short reach may
/// have a better one.
template <class Real, class Root>
[[gnu::always_inline]] inline Real longest_step(Real horizon, const Root& root) {
  Real tau = smaller(horizon, root(horizon));
  for (int attempt = 0; attempt < 2; ++attempt) {
    const auto shorter = tau < horizon;
    if (!any(shorter)) break;
    const Real reach = smaller(horizon, 2 * tau);
    tau = select(shorter, larger(tau, smaller(reach, root(reach))), tau);
  }
  return tau;
}

/// A time, at most `horizon`, up to which there is certainly no contact, for a gap g >= 0 that changes at rate gp, both
/// as computed. `curvature(reach)` bounds the curvature up to then, also as computed; a short reach may have a better
/// bound.
template <class Real, class Curvature>
[[gnu::always_inline]] inline Real step_by_parabola(Real g, Real gp, const RoundingOf<Real>& hidden, Real horizon,
                                                    const Curvature& curvature) {
  const Real least_g = larger(Real(0.0), g - hidden.gap);
  const Real least_gp = gp - hidden.rate;
  return longest_step(horizon,
                      [&](Real reach) { return first_root(least_g, least_gp, curvature(reach) + hidden.curvature); });
}

/// Whether Newton's method on d(t) is likely to be certified at a contact `spread` or so behind a certified bound.
template <class Real>
[[gnu::always_inline]] inline auto nearly_straight(Real gp, Real spread, Real size, Real speed, Real limit) {
  return (spread <= kTangentAgreement * size / speed) & (8 * spread * limit < -gp);
}

}  // namespace ed::internal
