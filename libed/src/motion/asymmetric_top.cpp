#include "motion/asymmetric_top.h"

#include "base/exponential.h"
#include "motion/elliptic.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Squares below this, relative to the largest moment and component of omega, are treated as zero.
constexpr double kNothing = 1e-270;

/// The part of the terms of D2 that is below their rounding.
constexpr double kBelowRounding = 0x1p-56;

// ---- Quadrature ----------------------------------------------------------------------------------------------------

/// A Gauss-Legendre rule: half of its nodes on [-1, 1], the others are opposite, and their weights.
struct GaussRule {
  double longest;  ///< longest piece, times the rate
  std::span<const std::array<double, 2>> nodes;
};

constexpr std::array<std::array<double, 2>, 2> kFourNodes{
    {{0.33998104358485626480, 0.65214515486254614263}, {0.86113631159405257522, 0.34785484513745385737}}};
constexpr std::array<std::array<double, 2>, 3> kSixNodes{{{0.23861918608319690863, 0.46791393457269104739},
                                                          {0.66120938646626451366, 0.36076157304813860757},
                                                          {0.93246951420315202781, 0.17132449237917034504}}};
constexpr std::array<std::array<double, 2>, 4> kEightNodes{{{0.18343464249564980494, 0.36268378337836198297},
                                                            {0.52553240991632898582, 0.31370664587788728734},
                                                            {0.79666647741362673959, 0.22238103445337447054},
                                                            {0.96028985649753623168, 0.10122853629037625915}}};
constexpr std::array<std::array<double, 2>, 5> kTenNodes{{{0.14887433898163121088, 0.29552422471475287017},
                                                          {0.43339539412924719080, 0.26926671930999635509},
                                                          {0.67940956829902440623, 0.21908636251598204400},
                                                          {0.86506336668898451073, 0.14945134915058059315},
                                                          {0.97390652851717172008, 0.06667134430868813759}}};
constexpr std::array<GaussRule, 4> kGaussRules{
    {{1.0 / 16, kFourNodes}, {0.28, kSixNodes}, {0.6, kEightNodes}, {1, kTenNodes}}};

/// Returns the integral of f over [0, tau] by Gauss-Legendre rules on pieces of at most 1 / rate, the rate of the
/// motion. The poles of a top's motion lie (pi/2) / rate or farther from the real axis: at u = i K', K' >= pi/2, and p
/// <= max |omega| because p^2 / w3^2 = (|I3 - I2| / I1) (|I3 - I1| / I2) at dn = 1, both below 1 for a body. So f is
/// analytic in an ellipse about a piece of x / rate whose semi-axes sum to rho = pi / x + sqrt((pi / x)^2 + 1) times
/// its half-length, and the relative error with n nodes is some rho^(-2n) (Trefethen, Approximation Theory and
/// Approximation Practice, theorem 19.3): at the longest pieces of each rule 1e-16.
template <class F>
TurnedAngles integral(double tau, double rate, const F& f) {
  const double turns = std::abs(tau) * rate;
  const auto pieces = static_cast<std::int64_t>(std::clamp(std::ceil(turns), 1.0, 1e15));
  const auto fits = [&](const GaussRule& rule) { return turns <= rule.longest; };
  const auto* rule = std::find_if(kGaussRules.begin(), kGaussRules.end() - 1, fits);
  const double half = 0.5 * tau / static_cast<double>(pieces);
  TurnedAngles sum;
  for (std::int64_t k = 0; k < pieces; ++k) {
    const double middle = static_cast<double>(2 * k + 1) * half;
    for (const auto& [node, weight] : rule->nodes) {
      for (const double t : {middle - half * node, middle + half * node}) {
        const TurnedAngles at = f(t);
        sum.world += weight * at.world;
        sum.body += weight * at.body;
      }
    }
  }
  return {half * sum.world, half * sum.body};
}

// ---- Bounds --------------------------------------------------------------------------------------------------------

/// Squares of omega's components along axes 1, 2, 3 as functions of s = sn^2; A_i = (I_j - I_k) / I_i, whose signs are
/// those of the labels in cyclic order.
struct Squares {
  std::array<double, 3> w;  ///< largest values
  double k2;
  std::array<double, 3> A;

  std::array<double, 3> at(double s) const { return {w[0] * (1 - s), w[1] * s, w[2] * (1 - k2 * s)}; }

  /// Returns |d omega/dt|^2, each component A_i w_j w_k.
  double alpha(double s) const {
    const auto [a, b, c] = at(s);
    return A[0] * A[0] * b * c + A[1] * A[1] * c * a + A[2] * A[2] * a * b;
  }

  /// Returns |d2 omega/dt2|^2 in the world frame: components w_i [A_j w_k^2 (A_i - 1) + A_k w_j^2 (A_i + 1)], the
  /// derivative of alpha in the body plus omega x alpha.
  double jerk(double s) const {
    const std::array<double, 3> v = at(s);
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const int k = (i + 2) % 3;
      const double bracket = A[j] * v[k] * (A[i] - 1) + A[k] * v[j] * (A[i] + 1);
      sum += v[i] * bracket * bracket;
    }
    return sum;
  }
};

/// Returns the largest value on [0, 1] of a cubic polynomial f: at an end or where the derivative, computed from four
/// values, is zero.
template <class F>
double largest(const F& f) {
  const double f0 = f(0);
  const double f1 = f(1);
  // f = f0 + b s + c s^2 + d s^3 from its values at s = 0, 1/2, 1 and -1.
  const double odd = 0.5 * (f1 - f(-1));  // b + d
  const double c = 0.5 * (f1 + f(-1)) - f0;
  const double d = (2 * odd - 4 * (f(0.5) - f0 - 0.25 * c)) / 1.5;
  const double b = odd - d;
  double most = std::max(f0, f1);
  const double discriminant = c * c - 3 * b * d;
  if (discriminant >= 0) {
    // Roots of b + 2 c s + 3 d s^2 without cancellation.
    const double sum = -(c + std::copysign(std::sqrt(discriminant), c));
    for (const double s : {sum / (3 * d), b / sum}) {
      if (s > 0 && s < 1) most = std::max(most, f(s));
    }
  }
  return most;
}

// ---- Constants of a flight -----------------------------------------------------------------------------------------

/// Top in units in which the largest moment and the largest component of omega are in [1/2, 1), with labelled axes.
struct Flight {
  std::array<int, 3> axis;  ///< body axes 1, 2, 3
  std::array<double, 3> I, w;
  double scale;        ///< scale of omega
  double orientation;  ///< handedness of the labels in the body: 1, or -1 if left-handed
  double sense;        ///< sign of M2 relative to M3 at sn > 0
  double chi;          ///< sign(I2 - I1)
  double I21, I32, I31;
  double D1, D2, D3;
};

struct Moduli {
  double L, mean_rate;  ///< mean_rate: 2 E / L
  double s1, s2, s3;    ///< s1 > 0, the others with their signs
  double p;
  double k2, kc2;  ///< k^2, k'^2
  SinCos phi;      ///< amplitude of u at the start
};

/// Returns nullopt if the direction of omega is constant.
std::optional<Flight> labelled(const Vector3d& inertia, const Vector3d& omega_body) {
  if (omega_body.isZero(0)) return std::nullopt;
  int exponent_I = 0;
  int exponent_w = 0;
  std::frexp(inertia.maxCoeff(), &exponent_I);
  std::frexp(omega_body.cwiseAbs().maxCoeff(), &exponent_w);
  Flight f;
  f.scale = std::ldexp(1.0, exponent_w);
  f.axis = {0, 1, 2};
  std::sort(f.axis.begin(), f.axis.end(), [&](int a, int b) { return inertia[a] < inertia[b]; });
  for (int i = 0; i < 3; ++i) {
    f.I[i] = std::ldexp(inertia[f.axis[i]], -exponent_I);
    f.w[i] = std::ldexp(omega_body[f.axis[i]], -exponent_w);
  }
  f.orientation = (f.axis[1] - f.axis[0] + 3) % 3 == 1 ? 1 : -1;
  f.sense = f.orientation;
  f.chi = 1;
  double term1 = f.I[0] * (f.I[1] - f.I[0]) * f.w[0] * f.w[0];
  double term3 = f.I[2] * (f.I[2] - f.I[1]) * f.w[2] * f.w[2];
  if (term3 < term1) {
    std::swap(f.axis[0], f.axis[2]);
    std::swap(f.I[0], f.I[2]);
    std::swap(f.w[0], f.w[2]);
    std::swap(term1, term3);
    f.orientation = -f.orientation;
    f.chi = -1;
  }
  const auto [I1, I2, I3] = f.I;
  f.I21 = std::abs(I2 - I1);
  f.I32 = std::abs(I3 - I2);
  f.I31 = std::abs(I3 - I1);
  f.D1 = I2 * f.I21 * f.w[1] * f.w[1] + I3 * f.I31 * f.w[2] * f.w[2];
  f.D2 = std::max(term3 - term1, kBelowRounding * (term3 + term1));
  f.D3 = I1 * f.I31 * f.w[0] * f.w[0] + I2 * f.I32 * f.w[1] * f.w[1];
  if (f.D3 < kNothing || term3 + term1 < kNothing) return std::nullopt;
  return f;
}

Moduli moduli(const Flight& f) {
  const auto [I1, I2, I3] = f.I;
  Moduli m;
  const double L1 = I1 * f.w[0];
  const double L2 = I2 * f.w[1];
  const double L3 = I3 * f.w[2];
  m.L = std::sqrt(L1 * L1 + L2 * L2 + L3 * L3);
  m.mean_rate = (L1 * f.w[0] + L2 * f.w[1] + L3 * f.w[2]) / m.L;
  const double root3 = std::sqrt(f.D3);
  m.s1 = std::sqrt(I1 / f.I31) * root3 / m.L;
  m.s2 = std::copysign(std::sqrt(I2 / f.I32) * root3 / m.L, f.sense * f.w[2]);
  m.s3 = std::copysign(std::sqrt(I3 * f.D1 / f.I31) / m.L, f.w[2]);
  m.p = std::sqrt(f.I32 * f.D1 / (I1 * I2 * I3));
  m.k2 = f.I21 * f.D3 / (f.I32 * f.D1);
  m.kc2 = f.I31 * f.D2 / (f.I32 * f.D1);
  // cn and sn; their squares sum to 1 by the definition of D3.
  m.phi.cos = std::sqrt(I1 * f.I31) * f.w[0] / root3;
  m.phi.sin = std::sqrt(I2 * f.I32) * f.w[1] / root3 * std::copysign(1.0, m.s2);
  return m;
}

TopBounds top_bounds(const Flight& f, const Moduli& m) {
  Squares squares;
  for (int i = 0; i < 3; ++i) squares.A[i] = (f.I[(i + 1) % 3] - f.I[(i + 2) % 3]) / f.I[i];
  squares.w = {f.D3 / (f.I[0] * f.I31), f.D3 / (f.I[1] * f.I32), f.D1 / (f.I[2] * f.I31)};
  squares.k2 = m.k2;
  // |omega|^2 is linear in s and falls with it.
  const double unit = kBoundMargin * f.scale;
  return {unit * std::sqrt(squares.w[0] + squares.w[2]),
          unit * f.scale * std::sqrt(largest([&](double s) { return squares.alpha(s); })),
          unit * f.scale * f.scale * std::sqrt(largest([&](double s) { return squares.jerk(s); }))};
}

// ---- Series
// ----------------------------------------------------------------------------------------------------------

/// Theta function whose angle is the periodic part of phi, and the rate of that angle at u = K (over x or v).
struct ThetaAngle {
  Cubic re, im;
  double slope;
};

/// Returns theta4(x + i chi eta) (axis 3 leads) or theta1(x + i chi eta), times e^-eta: e^(-2 eta) = G, q e^(2 eta) =
/// h.
ThetaAngle trigonometric_angle(bool lead_is_3, double chi, const Nome& nome, double G, double h) {
  const double G2 = G * G;
  const Cubic powers{1, h, h * h, h * h * h};
  ThetaAngle t;
  if (lead_is_3) {
    // 1 + sum (-1)^n q^(n^2) 2 [cos 2nx cosh 2n eta - i chi sin 2nx sinh 2n eta]; sin 2nx / sin 2x = 1, y, y^2 - 1.
    const Cubic a = times(alternating(nome.less), powers);
    const Cubic g{1, G2, G2 * G2, G2 * G2 * G2};
    t.re = cosine_sum({1, 0.5 * a[1] * (1 + g[1]), 0.5 * a[2] * (1 + g[2]), 0.5 * a[3] * (1 + g[3])}, 1);
    const double b3 = a[3] * (1 - g[3]);
    t.im = scaled(-chi, {a[1] * (1 - g[1]) - b3, a[2] * (1 - g[2]), b3, 0});
    t.slope = -2 * value(t.im, -2) / value(t.re, -2);
  } else {
    // sum (-1)^n q^(n(n+1)) [sin (2n+1)x cosh (2n+1)eta + i chi cos (2n+1)x sinh (2n+1)eta].
    const Cubic a = times(alternating(nome.square), powers);
    const Cubic g{G, G2 * G, G2 * G2 * G, G2 * G2 * G2 * G};
    t.re = odd_sum({a[0] * (1 + g[0]), a[1] * (1 + g[1]), a[2] * (1 + g[2]), a[3] * (1 + g[3])}, 1);
    t.im = odd_sum({a[0] * (1 - g[0]), a[1] * (1 - g[1]), a[2] * (1 - g[2]), a[3] * (1 - g[3])}, -1);
    t.im = scaled(chi, t.im);
    t.slope = -value(t.im, -2) / value(t.re, -2);
  }
  return t;
}

/// Returns theta2(chi eta' - iv) (axis 3 leads) or theta1(chi eta' - iv), the results of Jacobi's transformation of the
/// functions above except for factors and a phase linear in time. At u = K their angles are chi eta' and chi (eta' - pi
/// / 2), and their logarithmic derivatives those of theta3 and theta4 at eta'.
ThetaAngle hyperbolic_angle(bool lead_is_3, double chi, const Nome& nome, const SinCos& eta) {
  std::array<SinCos, 8> multiple{{{0, 1}}};
  for (std::size_t n = 1; n < multiple.size(); ++n) multiple[n] = product(multiple[n - 1], eta);
  const Cubic a = lead_is_3 ? nome.square : alternating(nome.square);
  Cubic sines;
  Cubic cosines;
  double rise = 0;
  double sum = 1;
  for (std::size_t n = 0; n < 4; ++n) {
    sines[n] = a[n] * multiple[2 * n + 1].sin;
    cosines[n] = a[n] * multiple[2 * n + 1].cos;
    if (n == 0) continue;
    rise += 4 * static_cast<double>(n) * a[n] * multiple[2 * n].sin;
    sum += 2 * a[n] * multiple[2 * n].cos;
  }
  ThetaAngle t;
  t.slope = chi * rise / sum;
  if (lead_is_3) {
    t.re = odd_sum(cosines, -nome.q);
    t.im = scaled(chi, odd_sum(sines, nome.q));
  } else {
    t.re = scaled(chi, odd_sum(sines, -nome.q));
    t.im = scaled(-1, odd_sum(cosines, nome.q));
  }
  return t;
}

/// Sets the series for k^2 <= 1/2. cn = (theta4 / theta2) theta2(x) / theta4(x), sn = (theta3 / theta2) theta1(x) /
/// theta4(x), dn = (theta4 / theta3) theta3(x) / theta4(x) (Whittaker and Watson, Modern Analysis, sec. 22.11);
/// theta4(x) is left out.
void set_trigonometric(const Moduli& m, double chi, ThetaSeries& s) {
  const Landen landen(m.k2, std::sqrt(m.kc2));
  const Nome nome(landen.nome());
  s.rate = m.p * landen.mean();
  s.start = landen.argument(m.phi);
  s.m1 = scaled(m.s1 * nome.theta4 / nome.theta2, odd_sum(nome.more, -1));
  s.m2 = scaled(m.s2 * nome.theta3 / nome.theta2, odd_sum(alternating(nome.more), 1));
  s.m3 = scaled(m.s3 * nome.theta4 / nome.theta3, cosine_sum(nome.square, 1));
  // sc(eta, k') = s3 / s1; e^(-2 eta) follows from it or, if eta is beyond the middle, q e^(2 eta) from sc(K' - eta).
  const double k = std::sqrt(m.k2);
  const double s3 = std::abs(m.s3);
  const bool far = k * s3 * s3 > m.s1 * m.s1;
  const double decay = far ? landen.decay(m.s1, k * s3) : landen.decay(s3, m.s1);
  const double other = nome.q / decay;
  const ThetaAngle t = trigonometric_angle(s.lead_is_3, chi, nome, far ? other : decay, far ? decay : other);
  s.re = t.re;
  s.im = t.im;
  s.secular = s.secular - s.rate * t.slope;
}

/// Sets the series for k^2 > 1/2, after Jacobi's transformation: cn = (theta2 / theta4) theta4(iv) / theta2(iv), sn =
/// (theta3 / theta4) theta1(iv) / (i theta2(iv)), dn = (theta2 / theta3) theta3(iv) / theta2(iv).
void set_hyperbolic(const Moduli& m, double chi, ThetaSeries& s) {
  const double kc = std::sqrt(m.kc2);
  const Landen landen(m.kc2, std::sqrt(m.k2));
  const Nome nome(landen.nome());
  s.q = nome.q;
  s.edge = 1 / std::sqrt(nome.q);
  s.rate = m.p * landen.mean();
  s.half_period = std::numbers::pi * landen.mean() / agm(1, kc);
  s.m1 = scaled(m.s1 * nome.theta2 / nome.theta4, cosine_sum(alternating(nome.less), nome.q));
  s.m2 = scaled(m.s2 * nome.theta3 / nome.theta4, odd_sum(alternating(nome.square), nome.q));
  s.m3 = scaled(m.s3 * nome.theta2 / nome.theta3, cosine_sum(nome.less, nome.q));
  // cn(u) < 0 means u beyond K: one reduction by 2 K, which changes the signs of cn and sn. sc(u, k) gives e^(-2v);
  // beyond the middle, sc(K - u) is the smaller.
  const bool beyond = m.phi.cos < 0;
  const double sn = std::abs(m.phi.sin);
  const double cn = std::abs(m.phi.cos);
  const bool far = kc * sn * sn > cn * cn;
  const double decay = far ? nome.q / landen.decay(cn, kc * sn) : landen.decay(sn, cn);
  s.start_half_turns = beyond ? 1 : 0;
  s.start_exp = (m.phi.sin < 0) != beyond ? std::sqrt(decay) : 1 / std::sqrt(decay);
  const double length = std::sqrt(m.s1 * m.s1 + m.s3 * m.s3);
  const SinCos eta = landen.argument({std::abs(m.s3) / length, m.s1 / length});
  const ThetaAngle t = hyperbolic_angle(s.lead_is_3, chi, nome, eta);
  s.re = t.re;
  s.im = t.im;
  s.secular = s.secular - s.rate * t.slope;
  s.jump = s.lead_is_3 ? 2 * chi * angle_of(eta) : -2 * chi * angle_of({eta.cos, eta.sin});
}

ThetaSeries theta_series(const Flight& f, const Moduli& m) {
  ThetaSeries s{};
  s.hyperbolic = m.k2 > m.kc2;
  s.lead_is_3 = m.s1 >= std::abs(m.s3);
  s.secular = s.lead_is_3 ? m.L / f.I[1] : m.mean_rate;  // phi' at u = K
  if (s.hyperbolic) {
    set_hyperbolic(m, f.chi, s);
  } else {
    set_trigonometric(m, f.chi, s);
  }
  s.rate *= f.scale;
  s.secular *= f.scale;
  return s;
}

// ---- Evaluation
// ------------------------------------------------------------------------------------------------------

/// Factors and argument of the polynomials, and the secular part of phi.
struct Phase {
  double f1, f2, f3;
  double re, im;
  double y;
  double angle;
};

[[gnu::always_inline]] inline Phase trigonometric_phase(const ThetaSeries& s, double tau) {
  const SinCos x = product(s.start, turn(s.rate * tau));
  const double y = 2 * (x.cos - x.sin) * (x.cos + x.sin);
  const double angle = s.secular * tau;
  if (s.lead_is_3) return {x.cos, x.sin, 1, 1, 2 * x.sin * x.cos, y, angle};
  return {x.cos, x.sin, 1, x.sin, x.cos, y, angle};
}

/// Returns the phase with all factors divided by cosh v: no square overflows.
[[gnu::always_inline]] inline Phase hyperbolic_phase(const ThetaSeries& s, double tau) {
  double v = s.rate * tau;
  double turns = std::nearbyint(v / s.half_period);
  if (std::abs(turns) > 1e6) [[unlikely]] {
    const double rest = std::remainder(v, s.half_period);
    turns = std::nearbyint((v - rest) / s.half_period);
    v = rest;
  } else {
    v -= turns * s.half_period;
  }
  double e = s.start_exp * exponential(v);
  if (e > s.edge) {
    e *= s.q;
    turns += 1;
  } else if (e * s.edge < 1) {
    e /= s.q;
    turns -= 1;
  }
  const double angle = s.secular * tau + turns * s.jump;
  const double half = 0.5 * (turns + s.start_half_turns);
  const double sign = half == std::floor(half) ? 1 : -1;
  const double e2 = e * e;
  const double inverse = 1 / (e2 + 1);
  const double sech = 2 * e * inverse;
  const double tanh = (e2 - 1) * inverse;
  return {sign * sech, sign * tanh, sech, 1, tanh, s.q * (e2 + 1 / e2), angle};
}

[[gnu::always_inline]] inline Phase phase(const ThetaSeries& s, double tau) {
  return s.hyperbolic ? hyperbolic_phase(s, tau) : trigonometric_phase(s, tau);
}

/// Returns M up to length, in the order leading, next, last axis.
[[gnu::always_inline]] inline std::array<double, 3> momentum(const ThetaSeries& s, const Phase& f) {
  const double m1 = f.f1 * value(s.m1, f.y);
  const double m2 = f.f2 * value(s.m2, f.y);
  const double m3 = f.f3 * value(s.m3, f.y);
  return s.lead_is_3 ? std::array{m3, m1, m2} : std::array{m1, m2, m3};
}

/// Columns of the rotation from the body to the frame of L (l along z): those of the leading and the next axis, and the
/// z component of the last.
struct Columns {
  Vector3d lead, next;
  double last_z;
};

/// Computes the columns. `orientation`: handedness of the leading, next and last axis in the body.
[[gnu::always_inline]] inline Columns columns(const ThetaSeries& s, double orientation, double tau) {
  const Phase f = phase(s, tau);
  const auto [a, b, c] = momentum(s, f);
  const double re = f.re * value(s.re, f.y);
  const double im = f.im * value(s.im, f.y);
  const SinCos sc = turn(f.angle);
  // With M of length 1, rho^2 = M_b^2 + M_c^2 and z = exp(i phi), the first two columns across l are rho z and z (-M_a
  // M_b + i M_c) / rho.
  const double rho2 = b * b + c * c;
  const double inverse = 1 / std::sqrt(rho2 + a * a);
  const double unit = 1 / std::sqrt(rho2 * (re * re + im * im));
  const double zx = unit * (sc.cos * re - sc.sin * im);
  const double zy = unit * (sc.sin * re + sc.cos * im);
  const double lead = rho2 * inverse;
  const double next = -a * b * inverse;
  const double aside = orientation * c;
  return {
      {lead * zx, lead * zy, a * inverse}, {next * zx - aside * zy, next * zy + aside * zx, b * inverse}, c * inverse};
}

[[gnu::always_inline]] inline TopAxes in_world(const Columns& b, const Matrix3d& world, double orientation) {
  return polished(product(world, b.lead), product(world, b.next), orientation);
}

}  // namespace

std::optional<AsymmetricTop> AsymmetricTop::make(const Vector3d& inertia, const Matrix3d& rotation,
                                                 const Vector3d& omega) {
  const Matrix3d R = matrix(polished(rotation.col(0), rotation.col(1), 1), {0, 1, 2});
  const std::optional<Flight> flight = labelled(inertia, transposed_product(R, omega));
  if (!flight) return std::nullopt;
  const Flight& f = *flight;
  const Moduli m = moduli(f);
  AsymmetricTop top;
  top.series_ = theta_series(f, m);
  top.bounds_ = top_bounds(f, m);
  top.orientation_ = f.orientation;
  top.mean_rate_ = f.scale * m.mean_rate;
  const std::array<int, 3> order = top.series_.lead_is_3 ? std::array{2, 0, 1} : std::array{0, 1, 2};
  for (int i = 0; i < 3; ++i) {
    const double I = f.I[order[i]];
    top.axes_[i] = f.axis[order[i]];
    top.rates_[i] = f.scale * (m.L / I);
    top.euler_[i] = f.orientation * (f.I[order[(i + 1) % 3]] - f.I[order[(i + 2) % 3]]) / I;
  }
  // The frame of L follows from the start.
  const Columns b = columns(top.series_, f.orientation, 0);
  const Matrix3d start = matrix(polished(b.lead, b.next, f.orientation), top.axes_);
  top.world_ = matrix(polished(product(R, start.row(2)), product(R, start.row(0)), 1), {2, 0, 1});
  return top;
}

Matrix3d AsymmetricTop::rotation(double tau) const {
  return matrix(in_world(columns(series_, orientation_, tau), world_, orientation_), axes_);
}

TopState AsymmetricTop::at(double tau) const {
  const Columns b = columns(series_, orientation_, tau);
  const TopAxes a = in_world(b, world_, orientation_);
  const double u = rates_[0] * b.lead.z();
  const double v = rates_[1] * b.next.z();
  const double w = rates_[2] * b.last_z;
  return {matrix(a, axes_), u * a.first + v * a.second + w * a.third,
          (euler_[0] * v * w) * a.first + (euler_[1] * w * u) * a.second + (euler_[2] * u * v) * a.third};
}

TurnedAngles AsymmetricTop::turned(double tau) const {
  const TurnedAngles sum = integral(tau, std::max(bounds_.omega, series_.rate), [this](double t) {
    const Columns b = columns(series_, orientation_, t);
    const Vector3d last = orientation_ * b.lead.cross(b.next);
    const Vector3d omega(rates_[0] * b.lead.z(), rates_[1] * b.next.z(), rates_[2] * b.last_z);
    return TurnedAngles{omega.x() * b.lead + omega.y() * b.next + omega.z() * last, omega};
  });
  TurnedAngles turned{product(world_, {sum.world.x(), sum.world.y(), mean_rate_ * tau}), {}};
  for (int i = 0; i < 3; ++i) turned.body[axes_[i]] = sum.body[i];
  return turned;
}

}  // namespace ed::internal
