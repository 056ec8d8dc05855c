#pragma once

/// An ellipsoid of revolution and a rod. Formulas for one pair, or for one in each lane of a vector, in the same order.
///
/// A is the ellipsoid, with h_A^2 = b^2 + c x_A^2, x_A = n.u_A (libgeom's uniaxial_pair.h), and B the rod, with h_B = l
/// |x_B| + R. -|y| is the smaller of y and -y: the gap is the least of two smooth functions, one for each end of the
/// rod,
///
///     g_s = n.(r + s u_B) - h_A(n) - R,   s = l and s = -l,
///
/// and the distance is the largest value of this minimum over all n. Newton's step of n takes the quadratic model of
/// both: with y and M as for two ellipsoids (dual_newton.h), the maximum over delta of y.delta - delta.M delta / 2 - l
/// |x_B + u_B.delta| is that of y + s p, p = u_B across n, where the one number s in [-l, l] either is an end or makes
/// x_B + u_B.delta = 0, with which an inner point of the rod is closest.
///
/// Let n turn from now on at a constant angular velocity across it, n' = dn, |dn| = W, and each axis at the rate w.
/// Then each g_s has, with the derivatives of f = n.(r + v tau) and of x = n.u as for two rods (pair.h),
///
///     g_s'' = f'' + s x_B'' - h_A'',    h_A'' = (c / h_A) (b^2 x_A'^2 / h_A^2 + x_A x_A''),
///
/// of which h_A'' is bounded over [0, tau] by the ranges of x_A, x_A' and x_A'' there. No contact comes before the
/// first root of the two parabolas with K >= -g_s''.

#include "base/select.h"
#include "contact/parabola_steps.h"
#include "contact/rods/parabolas.h"
#include "contact/rounding.h"

#include <cmath>

namespace ed::internal {

/// The gap along a normal n.
template <class Real>
struct MixedSampleOf {
  Real g;
  Real along;     ///< n.r
  Real x_a, x_b;  ///< n.u of both axes
  Real w2;        ///< square of the part of A's axis across n
  Real h;         ///< support function of A
  Real lever;     ///< c x_a / h
};

/// Newton step of n, not capped, and the point s u_B of the rod that it makes the closest.
template <class Real, class Vector>
struct MixedStepOf {
  Real decrement;
  Real delta2;  ///< |delta|^2
  Vector delta;
  Real s;
};

/// x_B below this is rounding: its share of g counts in what rounding hides, not in the decrement.
inline constexpr double kAcross = 4e-16;

/// Fixed parts of both axes, of bodies that spin.
template <class Vector, bool kSpin>
struct MixedSpin {
  Vector e0_a, e0_b;
};
template <class Vector>
struct MixedSpin<Vector, false> {};

/// Returns the scales of rounding of the pair: sums of those of an ellipsoid and of a rod, whose parts of g, g' and K
/// err by no more than two bodies of one family (rounding.h, pair.h).
template <class Real>
[[gnu::always_inline]] inline PairScalesOf<Real> mixed_scales(Real turning_limit, Real half_length, Real rate_a,
                                                              Real rate_b, Real size, Real places, Real speed,
                                                              Real origin) {
  return {.size = size,
          .places = places,
          .speed = speed,
          .surface_speed = size * (rate_a + rate_b),
          .bending = turning_limit * rate_a + half_length * rate_b,
          .limit = turning_limit * (rate_a * rate_a) + half_length * (rate_b * rate_b),
          .origin = origin};
}

/// An ellipsoid of revolution and a rod at one time.
template <class Real, class Vector, class Shape, bool kSpin>
struct MixedPairOf : MixedSpin<Vector, kSpin> {
  using Sample = MixedSampleOf<Real>;
  using Step = MixedStepOf<Real, Vector>;

  Shape shape;
  Real l, radius;  ///< half-length and radius of the rod
  Vector r, v;     ///< vector between the centres, relative velocity
  Vector u_a, u_b, du_a, du_b;
  Real rate_a, rate_b;  ///< w; 0 of an axis that does not move

  [[gnu::always_inline]] Sample sample(const Vector& n) const {
    using std::abs, std::sqrt;
    Sample at;
    at.along = n.dot(r);
    at.x_a = n.dot(u_a);
    at.x_b = n.dot(u_b);
    const Vector w = u_a - at.x_a * n;
    at.w2 = w.squaredNorm();
    at.h = sqrt(shape.b2 * at.w2 + shape.a2 * (at.x_a * at.x_a));
    at.lever = (shape.c * at.x_a) / at.h;
    at.g = ((at.along - at.h) - l * abs(at.x_b)) - radius;
    return at;
  }

  /// Returns whether the fixed normal n excludes a contact within the horizon, with the bounds L w^2 and l w^2 of the
  /// second derivatives. Concave functions that are positive at both ends have no root between.
  [[gnu::always_inline]] auto clears(const Sample& at, const Vector& n, const RoundingOf<Real>& hidden,
                                     Real horizon) const {
    using std::abs;
    const Real K = shape.turning_limit * (rate_a * rate_a) + l * (rate_b * rate_b) + hidden.curvature;
    const Real end_a = at.h + horizon * (at.lever * n.dot(du_a));
    const Real end_b = at.x_b + horizon * n.dot(du_b);
    const Real end = ((at.along + horizon * n.dot(v)) - end_a - l * abs(end_b)) - radius;
    return (at.g > hidden.gap) & (end - hidden.gap - horizon * (hidden.rate + 0.5 * K * horizon) > 0);
  }

  /// Returns the Newton step. `lift(sigma, t1)` returns sigma, raised if the matrix is not definite enough.
  template <class Lift>
  [[gnu::always_inline]] Step step(const Sample& at, const Vector& n, const Lift& lift) const {
    using std::abs;
    const Matrix M(*this, at, n, lift);
    const Vector y = (r - at.along * n) - at.lever * M.w;
    const Vector p = u_b - at.x_b * n;
    const Vector of_y = M.solve(y);
    const Vector of_p = M.solve(p);
    const Real pp = p.dot(of_p);
    const Real ahead = at.x_b + p.dot(of_y);
    const auto movable = pp > 0;
    const Real wanted = -ahead / select(movable, pp, 1.0);
    const Real s = select(movable, smaller(l, larger(-l, wanted)), select(ahead > 0, -l, l));
    const Vector delta = of_y + s * of_p;
    const Real bend = s * at.x_b + l * abs(at.x_b);
    const Real model = (y + s * p).dot(delta) + 2 * select(abs(at.x_b) > kAcross, bend, 0.0);
    return {larger(Real(0.0), model), delta.squaredNorm(), delta, s};
  }

  /// Returns dd/dt for the best normal n and the closest point s u_B.
  [[gnu::always_inline]] Real rate(const Sample& at, const Vector& n, Real s) const {
    return n.dot(v) - at.lever * n.dot(du_a) + s * n.dot(du_b);
  }

  /// Returns the rate at which the best normal turns where n is near it and s u_B is the closest point.
  template <class Lift>
  [[gnu::always_inline]] Vector turning(const Sample& at, const Vector& n, Real s, const Lift& lift) const {
    using std::abs;
    const Matrix M(*this, at, n, lift);
    const Vector p = u_b - at.x_b * n;
    const Vector moved = v + s * du_b - at.lever * du_a;
    const Vector y_rate = (moved - moved.dot(n) * n) - (M.e * n.dot(du_a)) * M.w;
    const Vector of_ends = M.solve(y_rate);
    const Vector of_p = M.solve(p);
    const Real pp = p.dot(of_p);
    const auto inner = (abs(s) < l) & (pp > 0);
    // x_B stays 0.
    const Real s_rate = select(inner, -(n.dot(du_b) + p.dot(of_ends)) / select(inner, pp, 1.0), 0.0);
    const Vector dn = of_ends + s_rate * of_p;
    return dn - dn.dot(n) * n;
  }

  /// Returns the point of the rod's axis that is nearest the origin, as a vector from A's centre, in the metric of the
  /// quadric of A with `ball2` added to the squares of the semi-axes; and sets `inside`: whether it is inside.
  [[gnu::always_inline]] Vector nearest_in_quadric(Real ball2, bool& inside) const {
    const Real inv_a = 1 / (shape.a2 + ball2);
    const Real inv_b = 1 / (shape.b2 + ball2);
    const auto product = [&](const Vector& p, const Vector& q) {
      const Real p_a = p.dot(u_a);
      const Real q_a = q.dot(u_a);
      return (p - p_a * u_a).dot(q - q_a * u_a) * inv_b + (p_a * q_a) * inv_a;
    };
    const Real s = smaller(l, larger(-l, -product(r, u_b) / product(u_b, u_b)));
    const Vector p = r + s * u_b;
    inside = !(product(p, p) > 1);
    const Real p_a = p.dot(u_a);
    return inv_b * (p - p_a * u_a) + (inv_a * p_a) * u_a;
  }

 private:
  /// M + g I across n, M the Hessians of both bodies: sigma I + e w w^T.
  struct Matrix {
    template <class Lift>
    [[gnu::always_inline]] Matrix(const MixedPairOf& pair, const Sample& at, const Vector& n, const Lift& lift)
        : w(pair.u_a - at.x_a * n) {
      const Real inv_h = 1 / at.h;
      const Real f = pair.shape.b2 * inv_h;
      e = (pair.shape.c * (inv_h * inv_h)) * f;
      const Real t1 = e * at.w2;
      const Real sigma = lift((f + pair.radius) + at.g, t1);
      sigma_inv = 1 / sigma;
      share = e / (sigma + t1);
    }
    [[gnu::always_inline]] Vector solve(const Vector& y) const { return sigma_inv * (y - (share * w.dot(y)) * w); }

    Vector w;  ///< A's axis across n
    Real e, sigma_inv, share;
  };
};

/// The two parabolas for a normal n that turns at the rate dn.
template <class Real, class Vector, class Shape, bool kSpin>
class MixedTurnOf : public ParabolasOf<MixedTurnOf<Real, Vector, Shape, kSpin>, Real> {
  using Base = ParabolasOf<MixedTurnOf, Real>;
  friend Base;

 public:
  using Pair = MixedPairOf<Real, Vector, Shape, kSpin>;

  /// Parameters as those of RodTurnOf.
  [[gnu::always_inline]] MixedTurnOf(const Pair& pair, const MixedSampleOf<Real>& at, const Vector& n, const Vector& dn,
                                     const RoundingOf<Real>& rounding, Real size, double direction = 1,
                                     double share = 1)
      : Base(rounding.gap), shape_(pair.shape), x_(at.x_a), share_(share) {
    using std::sqrt;
    const Real W2 = dn.squaredNorm();
    W_ = sqrt(W2);
    speed_ = sqrt(pair.v.squaredNorm());
    distance_ = sqrt(pair.r.squaredNorm());
    both_ = W_ + pair.rate_a;
    // dn is a choice, made across n but for rounding; r and the axes are known as they are for the gap. The lever
    // multiplies the rate of x_A as in the rate for n fixed, with W beside w.
    this->hidden_rate_ =
        rounding.rate + W_ * (rounding.gap + (64 * kRoundoff) * size) + (71 * kRoundoff) * (shape_.turning_limit * W_);
    const Real both_b = W_ + pair.rate_b;
    second_rod_ = pair.l * (both_b * both_b);
    third_rod_ = second_rod_ * both_b;

    const Real rate = direction * (dn.dot(pair.r) + n.dot(pair.v));
    dx_ = direction * (dn.dot(pair.u_a) + n.dot(pair.du_a));
    const Real dx_b = direction * (dn.dot(pair.u_b) + n.dot(pair.du_b));
    Real swing_a = at.x_a;
    Real swing_b = at.x_b;
    if constexpr (kSpin) {
      swing_a = at.x_a - n.dot(pair.e0_a);
      swing_b = at.x_b - n.dot(pair.e0_b);
    }
    ddx_ = 2 * dn.dot(pair.du_a) - (W2 * at.x_a + (pair.rate_a * pair.rate_a) * swing_a);
    const Real ddx_b = 2 * dn.dot(pair.du_b) - (W2 * at.x_b + (pair.rate_b * pair.rate_b) * swing_b);
    const Real bend = 2 * dn.dot(pair.v) - W2 * at.along;
    const Real slope = rate - at.lever * dx_;
    for (int k = 0; k < 2; ++k) {
      const Real s = (k == 0 ? 1.0 : -1.0) * pair.l;
      value_[k] = ((at.along - at.h) + s * at.x_b) - pair.radius;
      slope_[k] = slope + s * dx_b;
      bend_[k] = -(bend + s * ddx_b);
    }
  }

  /// Returns an upper bound of h_A'' over [0, reach]. With Omega = W + w of A, x_A'' changes by Omega^3 reach at most,
  /// and is Omega^2 at most, as |x_A'| is Omega at most. Each factor is taken at its own worst end.
  [[gnu::always_inline]] Real height_bound(Real reach) const {
    using std::abs, std::sqrt;
    const Real both2 = both_ * both_;
    const Real change = (both2 * both_) * reach;
    const Real ddx_low = larger(-both2, ddx_ - change);
    const Real ddx_high = smaller(both2, ddx_ + change);
    const Real most = larger(abs(ddx_low), abs(ddx_high));
    const Real turn = most * reach;
    const Real dx_most = smaller(both_, abs(dx_) + turn);
    const Real dx_least = larger(Real(0.0), abs(dx_) - turn);
    const Real swing = (0.5 * turn) * reach;
    const Real low = larger(Real(-1.0), x_ + reach * smaller(0.0, dx_) - swing);
    const Real high = smaller(Real(1.0), x_ + reach * larger(0.0, dx_) + swing);
    const Real low2 = low * low;
    const Real high2 = high * high;
    const Real x2_least = select(low * high <= 0, Real(0.0), smaller(low2, high2));
    const Real x2_most = larger(low2, high2);
    const auto rod = shape_.c > 0;
    const Real inner = sqrt(shape_.b2 + shape_.c * x2_least);
    const Real outer = sqrt(larger(smaller(shape_.a2, shape_.b2), shape_.b2 + shape_.c * x2_most));
    const Real h_min = select(rod, inner, outer);
    const Real h_max = select(rod, outer, inner);
    const Real p = low * ddx_low;
    const Real q = low * ddx_high;
    const Real v = high * ddx_low;
    const Real z = high * ddx_high;
    const Real pull = select(rod, larger(larger(p, q), larger(v, z)), -smaller(smaller(p, q), smaller(v, z)));
    const Real size = abs(shape_.c);
    const Real of_pull = pull / select(pull > 0, h_min, h_max);
    const Real of_rate =
        select(rod, (dx_most * dx_most) / (h_min * h_min * h_min), -(dx_least * dx_least) / (h_max * h_max * h_max));
    return size * (of_pull + shape_.b2 * of_rate);
  }

 private:
  /// Calls f(value, rate, K) for both parabolas over [0, reach].
  template <class F>
  [[gnu::always_inline]] void each(Real reach, const F& f) const {
    using std::abs;
    const Real far = W_ * (distance_ + speed_ * reach);
    const Real third = W_ * (W_ * (far + 3 * speed_)) + third_rod_;
    // Of a rod-like ellipsoid the bracket of h'' is at most (1 - x^2) Omega^2 + |x| Omega^2; of a disc less.
    const Real crude_a = 1.25 * shape_.turning_limit * (both_ * both_);
    const Real crude = W_ * (far + 2 * speed_) + second_rod_ + crude_a;
    const Real bound = height_bound(reach);
    const Real ahead = third * ((1.0 / 3) * reach) + bound;
    const Real more = kCurvatureRounding * (crude + abs(bound));
    for (int k = 0; k < 2; ++k) f(value_[k], slope_[k], share_ * (smaller(crude, bend_[k] + ahead) + more));
  }

  const Shape& shape_;
  Real x_, dx_, ddx_;  ///< x_A and its derivatives
  double share_;
  Real W_, both_;                       ///< W, and W + w of A
  Real distance_, speed_;               ///< |r| and |v|
  Real second_rod_, third_rod_;         ///< bounds of the second and third derivatives of l x_B
  Real value_[2], slope_[2], bend_[2];  ///< g, g' and the part of -g'' without A, of each end
};

/// Returns a time, at most `horizon`, up to which there is certainly no contact of bodies with the gap g along n, whose
/// best normal turns at `turning`, and which move at `speed` at most. A step that is enough(step) is not made longer.
template <class Real, class Vector, class Shape, bool kSpin, class Enough>
[[gnu::always_inline]] inline Real mixed_step(const MixedPairOf<Real, Vector, Shape, kSpin>& pair,
                                              const MixedSampleOf<Real>& at, const Vector& n, const Vector& turning,
                                              Real g, Real lift, const RoundingOf<Real>& hidden, Real size, Real speed,
                                              Real horizon, const Enough& enough, double share = 1) {
  const auto step_of = [&](const Vector& dn) {
    const MixedTurnOf<Real, Vector, Shape, kSpin> turn(pair, at, n, dn, hidden, size, 1, share);
    return longest_step(horizon, [&](Real reach) { return turn.step(reach, lift); });
  };
  const Real certain = smaller(horizon, larger(Real(0.0), g - hidden.gap) / speed);
  const Real with_points = larger(certain, step_of(turning));
  const auto satisfied = enough(with_points);
  if (all(satisfied)) return with_points;
  return select(satisfied, with_points, larger(with_points, step_of(Real(0.0) * n)));
}

}  // namespace ed::internal
