#pragma once

/// Steps by the parabolas that bound the gap of pairs with rods, while the normal turns at a chosen rate.

#include "base/select.h"
#include "contact/first_root.h"

namespace ed::internal {

/// Base of RodTurnOf and MixedTurnOf. `Turn` has each(reach, f), which calls f(value, rate, K) for each parabola
/// value + rate t - K t^2 / 2 over [0, reach]; the gap is above all of them.
template <class Turn, class Real>
class ParabolasOf {
 public:
  Real hidden_rate() const { return hidden_rate_; }  ///< bound of what rounding hides of the rate

  /// Returns a time, at most `reach`, up to which there is certainly no contact. `lift`: what is added to g, which may
  /// be below 0 by rounding if the bodies touch.
  [[gnu::always_inline]] Real step(Real reach, Real lift) const {
    Real tau = reach;
    turn().each(reach, [&](Real value, Real slope, Real K) {
      const Real least = larger(Real(0.0), (value + lift) - hidden_gap_);
      const Real least_slope = slope - hidden_rate_;
      // A concave function that is positive at both ends has no root between.
      const auto stays = least + reach * (least_slope - 0.5 * larger(Real(0.0), K) * reach) > 0;
      if (!all(stays)) tau = select(stays, tau, smaller(tau, first_root(least, least_slope, K)));
    });
    return tau;
  }

  /// Returns whether the gap is certainly above `least` a time tau later, and at no time before below the smaller of
  /// that and its value now.
  [[gnu::always_inline]] bool stays_above(Real least, Real tau) const {
    bool above = true;
    turn().each(tau, [&](Real value, Real slope, Real K) {
      above = above && value + tau * (slope - hidden_rate_) - (0.5 * tau * tau) * larger(Real(0.0), K) > least;
    });
    return above;
  }

 protected:
  /// `hidden_gap`: bound of what rounding hides of the gap. The rate's is set by the constructor of `Turn`.
  explicit ParabolasOf(Real hidden_gap) : hidden_gap_(hidden_gap) {}

  Real hidden_gap_, hidden_rate_;

 private:
  const Turn& turn() const { return static_cast<const Turn&>(*this); }
};

}  // namespace ed::internal
