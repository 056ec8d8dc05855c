#pragma once

/// Bounds of what rounding may hide from a certificate, and how the step pays for it.
///
/// Certified steps rest on g(tau) >= g + g' tau - K tau^2 / 2, true of real numbers. Computed are others, g_c, g'_c and
/// K_c. The bounds below are such that for the exact bodies (those that the numbers of both motions describe, axes made
/// exactly orthonormal, moved in real arithmetic) and the exact unit vector n / |n|
///
///     g >= g_c - gap,    g' >= g'_c - rate,    K <= K_c + curvature,
///
/// with what the root of the parabola and t + tau are rounded by included. The step is made of the numbers on the right
/// (curvature_steps.h, support_gap.cpp, convex/gap.cpp). Bodies with g_c <= gap cannot be told from touching ones.
///
/// Derivation for bodies of revolution. u = 2^-53 is the unit roundoff, gamma_n = n u / (1 - n u), and sums and
/// products are bounded as by Higham, Accuracy and Stability of Numerical Algorithms (2nd ed., 2002), ch. 2 and 3;
/// terms in u^2 are left out here and in what the sums below are rounded up by (no underflow, no overflow, no more than
/// 2^20 radian of turning). S is the sum of both bounding radii R, V the sum of both speeds, W that of both R Omega; P
/// the sum of both |positions|; T bounds |t|, |now| and all differences between t, now and the times of the motions. c,
/// h, x, lever and w as in uniaxial_pair.h, L = |c| / min(a, b) the turning limit.
///
/// In units of u:
///   normal         |n| = 1 + nu. step_on_sphere measures m.m (gamma_3), takes 1 / sqrt (half of that, and 2 for the
///                  series) and multiplies (1):                                              |nu| <= 5
///   axis           e1, e2 (and e0) are orthonormal to 4 each, 6 together; sincos errs by 2 each, 3 together
///                  (sincos.h); the linear combination by 4; its angle by 2 Omega T:     |du| <= 13 + 2 Omega T
///   now            positions at `now`: gamma_1 each of their sum, 2 V 2T of the path; the difference, the box length
///                  times an integer, and its subtraction: 3 P + 10 V T + 2 (S + 2 V T)
///   r              r = r_now + (t - now) v: 1 of the sum, S; 3 of the path, V T.
///                                                                        |dr| <= 3 S + 3 P + 17 V T
///   n.r            |dr|, gamma_3 of the product, nu:                      <= 11 S + 3 P + 17 V T
///   h, each body   changes by at most R |du| with the axis and by R |nu| with the normal. At given u and n: x errs by
///   3,
///                  which moves h by a x 3 a / h <= 3 a; w by |x| + |w| <= 2 in each of its parts beside the axis (an
///                  error of x moves w along n, across which it counts in second order), and h by b times that; 4 for
///                  the sums under the root and the squares of the semi-axes, 1 for the root
///                                                                                      <= 28 R + 2 R Omega T
///   g              two subtractions, 1 S each (g <= S):                  <= 41 S + 3 P + 17 V T + 2 W T
///   t + tau        the clock is rounded by 1 T; d changes at V + W:      <= (V + W) T
/// and 10 S for the root, see below: gap = u (52 S + 3 P + 18 V T + 4 W T) at least.
///
///   n.v            9 V: v (1), gamma_3, nu
///   n.du           Omega (gamma_3 + nu + 13 + 1 for the factor Omega) + 2 Omega^2 T = 22 Omega + 2 Omega^2 T
///   lever (n.du)   |lever| <= L. |n.du| <= Omega |w|, and with it: c dx / h <= L dx, dx = 21 + 2 Omega T (gamma_3, nu,
///                  13 and the angle); lever |w| dh / h <= |a - b| (R / min(a, b)) (28 + 2 Omega T) <= L (28 + 2 Omega
///                  T); 7 |lever| |w| <= 7 R for its own operations, 1 R for the product. In all, of each body,
///                                                            <= L Omega (71 + 6 Omega T) + 8 R Omega
///   g'             two subtractions, V + W each; 10 |g'| for the root:
///                                          rate = u (21 (V + W) + 71 sum(L Omega) + 6 T sum(L Omega^2)) at least.
///
///   K              is a Lipschitz function of s = x^2, of (x')^2 / Omega^2 and of C, with constants of at most 5 X^2 L
///                  Omega^2, X the aspect ratio: h^2 = b^2 + c s is at least min(a, b)^2, and b^2 (r^2 - s) / h^2 <= 1.
///                  s and the others err by 45 + 4 Omega T; the ends of the reach of x by no more than 112 in s, where
///                  r, which multiplies (Omega tau)^2, is rounded up (support_curvature.h). So K errs by less than
///                  (1000 X^2 + 20 X Omega T) u L Omega^2, which for X <= geom::kMaxAspectRatio = 1e4 is below
///                                          curvature = kCurvatureRounding sum(L Omega^2).
///
/// Derivation for other bodies, in units of u, as above where nothing else is said:
///   direction      n seen from a body: FreeTop promises 2e-15 (1 + Omega T) of its axes and rates, 18 (1 + Omega T);
///                  products with the axes 4, nu 5; as much again for rates of change and products made of them:
///                                                                direction = u (64 + 20 Omega T), of a unit vector
///   h              a support function changes by at most R |dn|, however edged the body: 27 R + 18 R Omega T. Its own
///                  operations: logarithm and exponential err by 2 (1 ulp), so that t^(q-1) t contributes (q - 1) t^q
///                  (2 |ln t| + 4 |ln a|) / q <= 23 to N_q for semi-axes a between 1/1000 and 1000 units of length, and
///                  roots and sums 10: 66 R of both norms and 8 for products. A user's support function is taken at its
///                  word: right to 80 R
///   majorants      made of the same powers: an ellipsoid larger by a relative 40 is one without doubt
///   g              11 S + 3 P + 17 V T of the centres, 2 S of subtractions, (V + W) T of the clock, 10 S of the root:
///                                                    gap = u (185 S + 3 P + T (18 V + 20 W)) at least
///   g'             n.v as above, levers and largest rates by a relative 12: rate = u 21 (V + W).
///
/// Of a certificate with moving normals (support_gap.h) the direction seen from a body is known to `direction`, and
/// so are its change mu1 tau, relative to |Omega| + |omega|, and mu2 tau^2 / 2, relative to (|Omega| + |omega|)^2 +
/// |alpha|. That moves h by at most R times as much, whatever D, and is added to g' and K. So rounding is not
/// multiplied by the Hessian of a face.
///
/// The root. What first_root computes is the exact root of a parabola whose coefficients differ by few u each: the
/// discriminant's two terms carry relative errors 1 and 3, which moved to the coefficients makes it exact; of what is
/// left all sums are of numbers of one sign, so that tau = tau' (1 + delta), |delta| <= 8 u, tau' the root; and tau is
/// the root for g' / (1 + delta) and K / (1 + delta)^2. So is (t + tau) rounded, 2 more. Hence 10 |g| <= 10 S, 10 |g'|,
/// and 20 |K|, which the bounds include.

#include "base/select.h"

#include <cmath>

namespace ed::internal {

/// Unit roundoff of double.
inline constexpr double kRoundoff = 0x1p-53;

/// See K above: 1000 kMaxAspectRatio^2 kRoundoff, rounded up. It costs steps a hundred thousandth of their length.
inline constexpr double kCurvatureRounding = 1.2e-5;

/// Bounds of what rounding hides of one pair at one time.
template <class Real>
struct RoundingOf {
  Real gap;
  Real rate;
  Real curvature;
};
using Rounding = RoundingOf<double>;

/// |x| + |y| + |z| >= |v|, without a square root.
template <class Vector>
[[gnu::always_inline]] inline auto sum_of_magnitudes(const Vector& v) {
  using std::abs;
  return (abs(v.x()) + abs(v.y())) + abs(v.z());
}

/// The scales of a pair of bodies of revolution that its rounding errors are measured by. Of one pair, or of one in
/// each lane of a vector.
template <class Real>
struct PairScalesOf {
  Real size;           ///< S
  Real places;         ///< P or more
  Real speed;          ///< V or more
  Real surface_speed;  ///< W or more
  Real bending;        ///< sum of L Omega
  Real limit;          ///< sum of L Omega^2
  Real origin;         ///< the largest of |now| and both |time|

  [[gnu::always_inline]] RoundingOf<Real> rounding(Real t) const {
    using std::abs;
    const Real T = abs(t) + origin;
    return {kRoundoff * ((52 * size + 3 * places) + T * (18 * speed + 4 * surface_speed)),
            kRoundoff * ((21 * (speed + surface_speed) + 71 * bending) + (6 * T) * limit), kCurvatureRounding * limit};
  }
};

/// Bounds of what rounding hides of two bodies of any kind at one time.
struct GeneralRounding {
  double gap;
  double rate;
  double direction;  ///< error of a unit vector seen from a body
};

/// Scales of a pair of bodies of any kind, as PairScalesOf for bodies of revolution.
struct GeneralScales {
  double size;           ///< S
  double places;         ///< P or more
  double speed;          ///< V or more
  double surface_speed;  ///< W or more
  double omega;          ///< the larger of both bodies' greatest |omega|
  double origin;         ///< the largest of |now| and both |time|

  template <class Motion>
  static GeneralScales of(double reach_a, const Motion& a, double reach_b, const Motion& b, double now) {
    return {.size = reach_a + reach_b,
            .places = sum_of_magnitudes(a.position) + sum_of_magnitudes(b.position),
            .speed = sum_of_magnitudes(a.velocity) + sum_of_magnitudes(b.velocity),
            .surface_speed = reach_a * a.top.max_omega() + reach_b * b.top.max_omega(),
            .omega = larger(a.top.max_omega(), b.top.max_omega()),
            .origin = larger(std::abs(now), larger(std::abs(a.time), std::abs(b.time)))};
  }

  /// Returns what rounding may hide of g a time tau later, beyond what it hides now.
  double later(double tau) const { return kRoundoff * tau * (18 * speed + 20 * surface_speed); }

  GeneralRounding rounding(double t) const {
    const double T = std::abs(t) + origin;
    return {kRoundoff * ((185 * size + 3 * places) + T * (18 * speed + 20 * surface_speed)),
            kRoundoff * (21 * (speed + surface_speed)), kRoundoff * (64 + 20 * (omega * T))};
  }
};

}  // namespace ed::internal
