#pragma once

#include "base/select.h"

#include <cmath>

namespace ed::internal {

/// An interval of time; empty if begin >= end.
template <class Real>
struct WindowOf {
  Real begin;
  Real end;
};
using Window = WindowOf<double>;

/// Returns when the bounding spheres of two bodies (distance r, relative velocity v at `now`, radii adding up to
/// `reach`) overlap within [t_begin, t_end]. Of one pair, or of one in each lane.
///
/// The spheres are taken larger by more than rounding. With u = 2^-53 the terms of the discriminant have errors of 6 u
/// r^2 v^2 or less in all; 32 u (r^2 + reach^2) in the excess makes it larger by 32 u r^2 v^2, and the spheres that
/// meet by 8 u (r + reach): more than the relative rounding of both times, 6 u of a way of at most r + reach.
template <class Vector, class Real>
[[gnu::always_inline]] inline WindowOf<Real> sphere_window(const Vector& r, const Vector& v, Real reach, Real now,
                                                           Real t_begin, Real t_end) {
  using std::sqrt;
  constexpr double kMargin = 32 * 0x1p-53;
  const Real excess = (1 - kMargin) * r.squaredNorm() - (1 + kMargin) * (reach * reach);
  const Real approach = r.dot(v);
  const Real v2 = v.squaredNorm();
  const Real discriminant = approach * approach - v2 * excess;
  WindowOf<Real> window{t_begin, t_end};
  const auto apart = excess > 0;
  const auto missing = apart & ((approach >= 0) | (discriminant < 0));
  if (any(apart)) {
    if (all(missing)) return {t_end, t_end};
    window.begin = select(apart, larger(t_begin, now + excess / (sqrt(discriminant) - approach)), t_begin);
  }
  // The spheres part again only if they no longer overlap at the end.
  const Real span = t_end - now;
  const auto together = excess + span * (2 * approach + span * v2) <= 0;
  const auto part = (v2 > 0) & (discriminant > 0) & !together;
  if (any(part)) window.end = select(part, smaller(t_end, now + (sqrt(discriminant) - approach) / v2), t_end);
  if (any(missing)) window = {select(missing, t_end, window.begin), select(missing, t_end, window.end)};
  return window;
}

}  // namespace ed::internal
