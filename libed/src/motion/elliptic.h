#pragma once

/// Elliptic integrals and theta functions for one modulus, by arithmetic-geometric means, square roots and series: the
/// same bits on every processor. Notation: K(k), K' = K(k'), k'^2 = 1 - k^2, nome q = exp(-pi K'/K).

#include "base/sincos.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace ed::internal {

/// Coefficients of 1, y, y^2, y^3.
using Cubic = std::array<double, 4>;

/// Returns the polynomial at a number, or at one in each lane of a vector.
template <class Real>
[[gnu::always_inline]] inline Real value(const Cubic& p, Real y) {
  return p[0] + y * (p[1] + y * (p[2] + y * p[3]));
}

inline Cubic scaled(double factor, const Cubic& p) {
  return {factor * p[0], factor * p[1], factor * p[2], factor * p[3]};
}

/// Returns the product of unit complex numbers: the angles add up.
inline SinCos product(const SinCos& a, const SinCos& b) {
  return {a.sin * b.cos + a.cos * b.sin, a.cos * b.cos - a.sin * b.sin};
}

/// Returns the arithmetic-geometric mean (Gauss): K(k) = pi / (2 agm(1, k')).
inline double agm(double a, double b) {
  while (std::abs(a - b) > 1e-9 * a) {
    const double next = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = next;
  }
  return 0.5 * (a + b);
}

/// Steps of the arithmetic-geometric mean of 1 and the complementary modulus for a modulus with k^2 <= 1/2, and the
/// functions computed by descending them (Landen's transformation; Abramowitz and Stegun, sec. 17.5, 17.6). After five
/// steps a - b < 1e-21.
class Landen {
 public:
  Landen(double k2, double complement) {
    double a = 1;
    double b = complement;
    double difference = k2 / (1 + complement);
    for (Step& step : steps_) {
      const double roots = std::sqrt(a) + std::sqrt(b);
      step = {a, b, difference, 0.5 / (roots * roots)};
      difference *= difference * step.shrink;
      const double next = 0.5 * (a + b);
      b = std::sqrt(a * b);
      a = next;
    }
    mean_ = a;
    const double root = std::sqrt(complement);
    const double e = 0.5 * k2 / ((1 + complement) * (1 + root) * (1 + root));
    const double e4 = (e * e) * (e * e);
    nome_ = e * (1 + e4 * (2 + e4 * (15 + e4 * (150 + e4 * 1707))));
  }

  double mean() const { return mean_; }  ///< agm(1, k') = pi / (2 K)

  /// Returns exp(-pi K'/K) by Weierstrass' series in e = (1 - sqrt k') / (2 (1 + sqrt k')) (Whittaker and Watson, sec.
  /// 21.8).
  double nome() const { return nome_; }

  /// Returns exp(i pi F(phi, k) / (2 K)) from exp(i phi). A step: tan(phi' - phi) = (b / a) tan phi, phi' = 2 phi + d
  /// with |d| < pi / 2; pi F / (2 K) = phi + sum of d_n / 2^(n+1).
  SinCos argument(SinCos phi) const {
    constexpr int kReal = kSteps - 1;  // later d are below 1e-21
    std::array<SinCos, kReal> d;
    SinCos p = phi;
    for (int n = 0; n < kReal; ++n) {
      const Step& s = steps_[n];
      const double re = s.a * p.cos * p.cos + s.b * p.sin * p.sin;
      const double im = -s.difference * p.sin * p.cos;
      const double length = std::sqrt(re * re + im * im);
      d[n] = {im / length, re / length};
      p = product(product(p, p), d[n]);
    }
    SinCos sum{0, 1};
    for (int n = kReal - 1; n >= 0; --n) sum = half(product(sum, d[n]));
    return product(phi, sum);
  }

  /// Returns exp(-pi w / K) where sc(w, k') = s / c; s, c >= 0. The steps are those of argument() with imaginary phi =
  /// i chi, sinh chi = s / c, and all differences positive. This holds for w <= K'/2, that is k s^2 <= c^2; beyond,
  /// K' - w satisfies it: sc(K' - w) = 1 / (k sc(w)).
  double decay(double s, double c) const {
    const double root = (s + std::sqrt(s * s + c * c)) / c;
    const double e = root * root;  // e^(2 chi)
    double y = steps_[0].difference * e;
    double z = steps_[0].difference / e;
    std::array<double, kSteps> r;  // e^(2 d)
    for (int n = 0; n < kSteps; ++n) {
      const Step& step = steps_[n];
      const double sum = step.a + step.b;
      r[n] = (sum + z) / (sum + y);
      y *= y * r[n] * step.shrink;
      z *= z / r[n] * step.shrink;
    }
    double correction = 1;
    for (int n = kSteps - 1; n >= 0; --n) correction = std::sqrt(correction * r[n]);
    return 1 / (e * correction);
  }

 private:
  static constexpr int kSteps = 5;
  struct Step {
    double a, b, difference, shrink;
  };

  /// Returns the square root of a unit complex number with positive real part.
  static SinCos half(const SinCos& a) {
    const double cos = std::sqrt(0.5 * (1 + a.cos));
    return {0.5 * a.sin / cos, cos};
  }

  std::array<Step, kSteps> steps_;
  double mean_;
  double nome_;
};

/// Returns the angle in (-pi, pi] of a unit complex number: a guess accurate to 0.005 (Abramowitz and Stegun, sec.
/// 4.4), corrected twice by the arc sine's series of the sine of the remainder.
inline double angle_of(const SinCos& z) {
  const double x = std::min(std::abs(z.sin), std::abs(z.cos)) / std::max(std::abs(z.sin), std::abs(z.cos));
  constexpr double kPi = std::numbers::pi;
  double angle = x / (1 + 0.28 * x * x);
  if (std::abs(z.sin) > std::abs(z.cos)) angle = 0.5 * kPi - angle;
  if (z.cos < 0) angle = kPi - angle;
  if (z.sin < 0) angle = -angle;
  for (int round = 0; round < 2; ++round) {
    const SinCos sc = sincos(angle);
    const double sine = z.sin * sc.cos - z.cos * sc.sin;
    angle += sine * (1 + sine * sine / 6);
  }
  return angle;
}

inline Cubic times(const Cubic& a, const Cubic& b) {
  return {a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]};
}

/// Returns the coefficients with the factor (-1)^n.
inline Cubic alternating(const Cubic& a) {
  return {a[0], -a[1], a[2], -a[3]};
}

/// Returns the polynomial in y of sum a_n C_n with C_0 = 1, C_1 = y, C_2 = y^2 - 2 g^2, C_3 = y^3 - 3 g^2 y: C_n = 2
/// cos 2nx for y = 2 cos 2x, g = 1; C_n = 2 q^n cosh 2nv for y = 2 q cosh 2v, g = q.
inline Cubic cosine_sum(const Cubic& a, double g) {
  const double g2 = g * g;
  return {a[0] - 2 * g2 * a[2], a[1] - 3 * g2 * a[3], a[2], a[3]};
}

/// Returns the polynomial in y of sum a_n S_n with S_n = C_n + g C_{n-1} + ... + g^n: for g = -1, cos((2n+1) x) / cos
/// x; for g = 1, sin((2n+1) x) / sin x; for g = -q and q, q^n times the same with cosh and sinh.
inline Cubic odd_sum(Cubic a, double g) {
  for (int n = 2; n >= 0; --n) a[n] += g * a[n + 1];
  return cosine_sum(a, g);
}

/// Powers of a nome q <= exp(-pi) for n = 0 to 3, and the theta functions at 0.
struct Nome {
  explicit Nome(double nome) : q(nome) {
    const double q2 = q * q;
    const double q4 = q2 * q2;
    square = {1, q, q4, q4 * q4 * q};
    less = {1, 1, q2, q4 * q2};
    more = {1, q2, q4 * q2, q4 * q4 * q4};
    theta2 = more[0] + more[1] + more[2] + more[3];
    theta3 = 1 + 2 * (square[1] + square[2] + square[3]);
    theta4 = 1 - 2 * (square[1] - square[2] + square[3]);
  }

  double q;
  Cubic square;                   ///< q^(n^2)
  Cubic less;                     ///< q^(n^2 - n)
  Cubic more;                     ///< q^(n^2 + n)
  double theta2, theta3, theta4;  ///< theta2 / (2 q^(1/4)), theta3, theta4 at 0
};

}  // namespace ed::internal
