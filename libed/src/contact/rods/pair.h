#pragma once

/// Rods: capsules, and spheres as rods of no length. Formulas for one pair, or for one in each lane of a vector, in the
/// same order and with the same bits.
///
/// The support function of a rod of half-length a and radius R along the axis u is h(n) = a |n.u| + R. Let n turn from
/// now on at a constant angular velocity across it, n' = dn, |dn| = W, and the axis at the rate w about an axis of its
/// own (AxisMotion). Then x = n.u has
///
///     x' = dn.u + n.u',   x'' = -W^2 x + 2 dn.u' - w^2 (x - n.e0),   |x'''| <= (W + w)^3,   |x''| <= (W + w)^2,
///
/// and the centres' part f = n.(r + v tau)
///
///     f' = dn.r + n.v,    f'' = -W^2 n.r + 2 dn.v,    |f'''| <= W^2 (W |r + v tau| + 3 |v|).
///
/// The gap is the least of four smooth functions, as -|y| is the smaller of y and -y: one for each choice of the ends s
/// and t (+1 or -1) of both rods, f - R - s a x_A - t b x_B. Each of them is bounded from below over [0, tau] by the
/// parabola of its value and rate now and
///
///     K = -(f'' - s a x_A'' - t b x_B'') + (f''' + a x_A''' + b x_B''') tau / 3   (bounds of the third derivatives),
///
/// so that no contact comes before the first of the four roots. If n turns with the closest points this is exact to
/// second order in time, for two ends, an end beside a rod, and two rods that cross. Any dn across n is as certain: 0
/// is the other choice.

#include "base/select.h"
#include "contact/parabola_steps.h"
#include "contact/rods/parabolas.h"
#include "contact/rounding.h"

#include <cmath>

namespace ed::internal {

/// The gap along a normal n.
template <class Real>
struct RodSampleOf {
  Real g;
  Real along;     ///< n.r
  Real x_a, x_b;  ///< n.u of both axes
};

/// Closest points of the axes: s u_A from A's centre, t u_B from B's.
template <class Real>
struct RodPointsOf {
  Real s, t;
  Real c, sine2;  ///< cosine of the angle of the axes, and the square of its sine
};

/// Returns the closest points of two rods' axes: those of the lines, brought back into the rods one after the other. Of
/// lines that are parallel to rounding those in the middle of where both are. `a` and `b`: half-lengths.
template <class Real, class Vector>
[[gnu::always_inline]] inline RodPointsOf<Real> closest_on_rods(Real a, Real b, const Vector& r, const Vector& u_a,
                                                                const Vector& u_b) {
  // Numerator and denominator are made of u_A less its part along u_B: the error of s times |across|^2, which is the
  // angle by which the normal is wrong, stays at rounding however small the angle of the axes.
  constexpr double kParallel = 1e-28;
  const auto clamped = [](Real x, Real most) { return smaller(most, larger(-most, x)); };
  const Real c = u_a.dot(u_b);
  const Vector across = u_a - c * u_b;
  const Real sine2 = across.squaredNorm();
  const auto skew = (sine2 > kParallel) & (b > 0);
  const Real r_a = r.dot(u_a);
  const Real r_b = r.dot(u_b);
  const Real middle = 0.5 * (larger(-a, r_a - b) + smaller(a, r_a + b));
  const Real first = clamped(select(skew, r.dot(across) / select(skew, sine2, 1.0), middle), a);
  const Real t = clamped(c * first - r_b, b);
  return {clamped(r_a + c * t, a), t, c, sine2};
}

/// Returns the scales of rounding as for ellipsoids of revolution (rounding.h). With x = n.u known to 21 + 2 Omega T
/// and a |x| + R to 24 of the bounding radius, the gap errs by less than theirs, with a subtraction more; the rate by
/// less, with the half-length as turning limit.
template <class Real>
[[gnu::always_inline]] inline PairScalesOf<Real> rod_scales(Real a, Real b, Real rate_a, Real rate_b, Real size,
                                                            Real places, Real speed, Real origin) {
  return {.size = size,
          .places = places,
          .speed = speed,
          .surface_speed = size * (rate_a + rate_b),
          .bending = a * rate_a + b * rate_b,
          .limit = a * (rate_a * rate_a) + b * (rate_b * rate_b),
          .origin = origin};
}

/// Least distance of two rods' axes that has a direction, in units of the sum of the radii.
inline constexpr double kLeastRodDistance = 1e-8;

/// Fixed parts of both axes, of rods that spin.
template <class Vector, bool kSpin>
struct RodSpin {
  Vector e0_a, e0_b;
};
template <class Vector>
struct RodSpin<Vector, false> {};

/// Two rods at one time. `kSpin`: whether one may spin.
template <class Real, class Vector, bool kSpin>
struct RodPairOf : RodSpin<Vector, kSpin> {
  Real a, b;    ///< half-lengths
  Real balls;   ///< sum of the radii
  Vector r, v;  ///< vector between the centres, relative velocity
  Vector u_a, u_b, du_a, du_b;
  Real rate_a, rate_b;  ///< w; 0 of an axis that does not move

  [[gnu::always_inline]] RodSampleOf<Real> sample(const Vector& n) const {
    using std::abs;
    const Real along = n.dot(r);
    const Real x_a = n.dot(u_a);
    const Real x_b = n.dot(u_b);
    return {(along - (a * abs(x_a) + b * abs(x_b))) - balls, along, x_a, x_b};
  }

  /// Returns whether the fixed normal n excludes a contact within the horizon, with the bound w^2 of every x''. A
  /// concave function that is positive at both ends has no root between.
  [[gnu::always_inline]] auto clears(const RodSampleOf<Real>& at, const Vector& n, const RoundingOf<Real>& hidden,
                                     Real horizon) const {
    using std::abs;
    const Real K = a * (rate_a * rate_a) + b * (rate_b * rate_b) + hidden.curvature;
    const Real end_a = at.x_a + horizon * n.dot(du_a);
    const Real end_b = at.x_b + horizon * n.dot(du_b);
    const Real end = ((at.along + horizon * n.dot(v)) - (a * abs(end_a) + b * abs(end_b))) - balls;
    return (at.g > hidden.gap) & (end - hidden.gap - horizon * (hidden.rate + 0.5 * K * horizon) > 0);
  }

  [[gnu::always_inline]] RodPointsOf<Real> closest_points() const { return closest_on_rods(a, b, r, u_a, u_b); }

  /// Returns the vector between the closest points.
  [[gnu::always_inline]] Vector between(const RodPointsOf<Real>& at) const { return r + (at.t * u_b - at.s * u_a); }
  /// Returns its rate of change while both points stay where they are in the rods.
  [[gnu::always_inline]] Vector between_rate(const RodPointsOf<Real>& at) const {
    return v + (at.t * du_b - at.s * du_a);
  }

  /// Returns u_A and u_B times numbers, such that together they have the products p and q with the axes of those rods
  /// whose inner points are closest. Of nearly parallel rods only one is meant.
  [[gnu::always_inline]] Vector with_products(const RodPointsOf<Real>& at, Real p, Real q, Real p_else,
                                              Real q_else) const {
    const auto crossed = are_crossed(at);
    const Real inverse = 1 / select(crossed, at.sine2, 1.0);
    const Real of_a = select(is_inner_a(at), p_else, 0.0);
    const Real of_b = select(is_inner_a(at), 0.0, select(is_inner_b(at), q_else, 0.0));
    return select(crossed, (p - at.c * q) * inverse, of_a) * u_a +
           select(crossed, (q - at.c * p) * inverse, of_b) * u_b;
  }

  /// Returns the unit vector along `between`, of this length. Where inner points are closest it is across the axis;
  /// what rounding leaves along it, the longer the thinner the rods, is taken off.
  [[gnu::always_inline]] Vector normal(const RodPointsOf<Real>& at, const Vector& between, Real distance) const {
    const Vector n = (1 / distance) * between;
    const Real p = n.dot(u_a);
    const Real q = n.dot(u_b);
    return n - with_products(at, p, q, p, q);
  }

  /// Returns the rate at which n, the unit vector between the closest points, `distance` apart, turns with them: across
  /// the axis of a rod whose inner points are closest it follows the axis, else the points.
  [[gnu::always_inline]] Vector turning(const RodPointsOf<Real>& at, Real distance, const Vector& n) const {
    const Vector of_points = (1 / distance) * between_rate(at);
    const Real p = -n.dot(du_a);
    const Real q = -n.dot(du_b);
    const Real points_share = select(are_crossed(at), 0.0, 1.0);
    const Vector rate =
        points_share * of_points + with_products(at, p, q, p - of_points.dot(u_a), q - of_points.dot(u_b));
    // Twice: where the rate is nearly along n, what is left across it is made of rounding errors.
    const Vector once = rate - rate.dot(n) * n;
    return once - once.dot(n) * n;
  }

 private:
  [[gnu::always_inline]] auto is_inner_a(const RodPointsOf<Real>& at) const {
    using std::abs;
    return abs(at.s) < a;
  }
  [[gnu::always_inline]] auto is_inner_b(const RodPointsOf<Real>& at) const {
    using std::abs;
    return abs(at.t) < b;
  }
  [[gnu::always_inline]] auto are_crossed(const RodPointsOf<Real>& at) const {
    constexpr double kParallel = 1e-12;  // with a smaller squared sine only one rod's axis is followed
    const auto inner_a = is_inner_a(at);
    const auto inner_b = is_inner_b(at);
    return inner_a & inner_b & (at.sine2 > kParallel);
  }
};

/// The four parabolas for a normal n that turns at the rate dn.
template <class Real, class Vector, bool kSpin>
class RodTurnOf : public ParabolasOf<RodTurnOf<Real, Vector, kSpin>, Real> {
  using Base = ParabolasOf<RodTurnOf, Real>;
  friend Base;

 public:
  /// `direction`: 1, or -1 backwards in time, where velocities change their signs and accelerations do not. `size`:
  /// sum of the bounding radii. `share`: share of K that is taken; tests take less than 1, to see that contacts are
  /// missed then.
  [[gnu::always_inline]] RodTurnOf(const RodPairOf<Real, Vector, kSpin>& rods, const Vector& n, const Vector& dn,
                                   const RoundingOf<Real>& rounding, Real size, double direction = 1, double share = 1)
      : Base(rounding.gap), share_(share) {
    using std::sqrt;
    const Real W2 = dn.squaredNorm();
    W_ = sqrt(W2);
    speed_ = sqrt(rods.v.squaredNorm());
    distance_ = sqrt(rods.r.squaredNorm());
    // dn is a choice, made across n but for rounding; r and the axes are known as they are for the gap.
    this->hidden_rate_ = rounding.rate + W_ * (rounding.gap + (64 * kRoundoff) * size);
    const Real both_a = W_ + rods.rate_a;
    const Real both_b = W_ + rods.rate_b;
    const Real second_a = rods.a * (both_a * both_a);
    const Real second_b = rods.b * (both_b * both_b);
    second_ = second_a + second_b;
    third_ = second_a * both_a + second_b * both_b;

    const Real along = n.dot(rods.r);
    const Real x_a = n.dot(rods.u_a);
    const Real x_b = n.dot(rods.u_b);
    const Real rate = direction * (dn.dot(rods.r) + n.dot(rods.v));
    const Real dx_a = direction * (dn.dot(rods.u_a) + n.dot(rods.du_a));
    const Real dx_b = direction * (dn.dot(rods.u_b) + n.dot(rods.du_b));
    Real swing_a = x_a;
    Real swing_b = x_b;
    if constexpr (kSpin) {
      swing_a = x_a - n.dot(rods.e0_a);
      swing_b = x_b - n.dot(rods.e0_b);
    }
    const Real bend = 2 * dn.dot(rods.v) - W2 * along;
    const Real ddx_a = 2 * dn.dot(rods.du_a) - (W2 * x_a + (rods.rate_a * rods.rate_a) * swing_a);
    const Real ddx_b = 2 * dn.dot(rods.du_b) - (W2 * x_b + (rods.rate_b * rods.rate_b) * swing_b);
    int k = 0;
    for (const double s : {1.0, -1.0}) {
      for (const double t : {1.0, -1.0}) {
        const Real a = s * rods.a;
        const Real b = t * rods.b;
        value_[k] = (along - (a * x_a + b * x_b)) - rods.balls;
        slope_[k] = rate - (a * dx_a + b * dx_b);
        bend_[k] = (a * ddx_a + b * ddx_b) - bend;
        ++k;
      }
    }
  }

 private:
  /// Calls f(value, rate, K) for each parabola over [0, reach].
  template <class F>
  [[gnu::always_inline]] void each(Real reach, const F& f) const {
    const Real far = W_ * (distance_ + speed_ * reach);
    const Real third = W_ * (W_ * (far + 3 * speed_)) + third_;
    const Real crude = W_ * (far + 2 * speed_) + second_;
    const Real ahead = third * ((1.0 / 3) * reach);
    const Real more = kCurvatureRounding * crude;
    for (int k = 0; k < 4; ++k) f(value_[k], slope_[k], share_ * (smaller(crude, bend_[k] + ahead) + more));
  }

  double share_;
  Real W_;
  Real distance_, speed_;               ///< |r| and |v|
  Real second_, third_;                 ///< bounds of the second and third derivatives of both rods' heights
  Real value_[4], slope_[4], bend_[4];  ///< g, g' and -g'' of each choice of ends
};

/// Returns a time, at most `horizon`, up to which there is certainly no contact of rods with the closest points `at`,
/// `distance` apart along n, whose gap is g and which move at `speed` at most. A step that is
/// enough(step) is not made longer.
template <class Real, class Vector, bool kSpin, class Enough>
[[gnu::always_inline]] inline Real rod_step(const RodPairOf<Real, Vector, kSpin>& pair, const RodPointsOf<Real>& at,
                                            Real distance, const Vector& n, Real g, Real lift,
                                            const RoundingOf<Real>& hidden, Real size, Real speed, Real horizon,
                                            const Enough& enough, double share = 1) {
  const auto step_of = [&](const Vector& dn) {
    const RodTurnOf<Real, Vector, kSpin> turn(pair, n, dn, hidden, size, 1, share);
    return longest_step(horizon, [&](Real reach) { return turn.step(reach, lift); });
  };
  const Real certain = smaller(horizon, larger(Real(0.0), g - hidden.gap) / speed);
  const Real with_points = larger(certain, step_of(pair.turning(at, distance, n)));
  const auto satisfied = enough(with_points);
  if (all(satisfied)) return with_points;
  return select(satisfied, with_points, larger(with_points, step_of(Real(0.0) * n)));
}

}  // namespace ed::internal
