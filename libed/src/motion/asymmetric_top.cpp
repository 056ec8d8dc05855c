#include "motion/asymmetric_top.h"

#include "base/exponential.h"
#include "base/lanes.h"
#include "motion/asymmetric_flight.h"
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

// ---- Series

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
    t.slope = -2 * value(t.im, -2.0) / value(t.re, -2.0);
  } else {
    // sum (-1)^n q^(n(n+1)) [sin (2n+1)x cosh (2n+1)eta + i chi cos (2n+1)x sinh (2n+1)eta].
    const Cubic a = times(alternating(nome.square), powers);
    const Cubic g{G, G2 * G, G2 * G2 * G, G2 * G2 * G2 * G};
    t.re = odd_sum({a[0] * (1 + g[0]), a[1] * (1 + g[1]), a[2] * (1 + g[2]), a[3] * (1 + g[3])}, 1);
    t.im = odd_sum({a[0] * (1 - g[0]), a[1] * (1 - g[1]), a[2] * (1 - g[2]), a[3] * (1 - g[3])}, -1);
    t.im = scaled(chi, t.im);
    t.slope = -value(t.im, -2.0) / value(t.re, -2.0);
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

// ---- Evaluation, at one time or, in lanes, at two

/// Factors and argument of the polynomials, and the secular part of phi.
template <class Real>
struct Phase {
  Real f1, f2, f3;
  Real re, im;
  Real y;
  Real angle;
};

using internal::turn;

inline SinCosLanes turn(Lanes angle) {
  if (std::abs(angle[0]) <= kLargestAngle && std::abs(angle[1]) <= kLargestAngle) [[likely]]
    return sincos(angle);
  const SinCos a = turn(angle[0]);
  const SinCos b = turn(angle[1]);
  return {Lanes{a.sin, b.sin}, Lanes{a.cos, b.cos}};
}

template <class Real>
[[gnu::always_inline]] inline Phase<Real> trigonometric_phase(const ThetaSeries& s, Real tau) {
  const auto turned = turn(s.rate * tau);
  const Real sin = s.start.sin * turned.cos + s.start.cos * turned.sin;
  const Real cos = s.start.cos * turned.cos - s.start.sin * turned.sin;
  const Real one = Real{} + 1;
  const Real y = 2 * (cos - sin) * (cos + sin);
  const Real angle = s.secular * tau;
  if (s.lead_is_3) return {cos, sin, one, one, 2 * sin * cos, y, angle};
  return {cos, sin, one, sin, cos, y, angle};
}

/// Returns the phase with all factors divided by cosh v: no square overflows.
[[gnu::always_inline]] inline Phase<double> hyperbolic_phase(const ThetaSeries& s, double tau) {
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

[[gnu::always_inline]] inline Phase<double> phase(const ThetaSeries& s, double tau) {
  return s.hyperbolic ? hyperbolic_phase(s, tau) : trigonometric_phase(s, tau);
}

[[gnu::always_inline]] inline Phase<Lanes> phase(const ThetaSeries& s, Lanes tau) {
  if (!s.hyperbolic) return trigonometric_phase(s, tau);
  const Phase<double> a = hyperbolic_phase(s, tau[0]);
  const Phase<double> b = hyperbolic_phase(s, tau[1]);
  const auto pair = [](double x, double y) { return Lanes{x, y}; };
  return {pair(a.f1, b.f1), pair(a.f2, b.f2), pair(a.f3, b.f3),      pair(a.re, b.re),
          pair(a.im, b.im), pair(a.y, b.y),   pair(a.angle, b.angle)};
}

/// Returns M up to length, in the order leading, next, last axis.
template <class Real>
[[gnu::always_inline]] inline std::array<Real, 3> momentum(const ThetaSeries& s, const Phase<Real>& f) {
  const Real m1 = f.f1 * value(s.m1, f.y);
  const Real m2 = f.f2 * value(s.m2, f.y);
  const Real m3 = f.f3 * value(s.m3, f.y);
  return s.lead_is_3 ? std::array{m3, m1, m2} : std::array{m1, m2, m3};
}

/// Columns of the rotation from the body to the frame of L (l along z): those of the leading and the next axis, and the
/// z component of the last.
template <class Real>
struct Columns {
  std::array<Real, 3> lead, next;
  Real last_z;
};

/// Computes the columns. `orientation`: handedness of the leading, next and last axis in the body.
template <class Real>
[[gnu::always_inline]] inline Columns<Real> columns(const ThetaSeries& s, double orientation, Real tau) {
  const Phase<Real> f = phase(s, tau);
  const auto [a, b, c] = momentum(s, f);
  const Real re = f.re * value(s.re, f.y);
  const Real im = f.im * value(s.im, f.y);
  const auto sc = turn(f.angle);
  // With M of length 1, rho^2 = M_b^2 + M_c^2 and z = exp(i phi), the first two columns across l are rho z and z (-M_a
  // M_b + i M_c) / rho.
  const Real rho2 = b * b + c * c;
  const Real inverse = 1 / root(rho2 + a * a);
  const Real unit = 1 / root(rho2 * (re * re + im * im));
  const Real zx = unit * (sc.cos * re - sc.sin * im);
  const Real zy = unit * (sc.sin * re + sc.cos * im);
  const Real lead = rho2 * inverse;
  const Real next = -a * b * inverse;
  const Real aside = orientation * c;
  return {
      {lead * zx, lead * zy, a * inverse}, {next * zx - aside * zy, next * zy + aside * zx, b * inverse}, c * inverse};
}

/// Returns omega at the times of both lanes, in the frame of L and along the body's axes.
[[gnu::always_inline]] inline std::array<TurnedAngles, 2> angular_velocities(const ThetaSeries& s, double orientation,
                                                                             const std::array<double, 3>& rates,
                                                                             Lanes tau) {
  const auto [lead, next, last_z] = columns(s, orientation, tau);
  const std::array<Lanes, 3> last = {orientation * (lead[1] * next[2] - lead[2] * next[1]),
                                     orientation * (lead[2] * next[0] - lead[0] * next[2]),
                                     orientation * (lead[0] * next[1] - lead[1] * next[0])};
  const std::array<Lanes, 3> own = {rates[0] * lead[2], rates[1] * next[2], rates[2] * last_z};
  std::array<TurnedAngles, 2> omega;
  for (int i = 0; i < 3; ++i) {
    const Lanes across = own[0] * lead[i] + own[1] * next[i] + own[2] * last[i];
    for (int lane = 0; lane < 2; ++lane) {
      omega[lane].world[i] = across[lane];
      omega[lane].body[i] = own[i][lane];
    }
  }
  return omega;
}

[[gnu::always_inline]] inline Vector3d vector(const std::array<double, 3>& column) {
  return {column[0], column[1], column[2]};
}

[[gnu::always_inline]] inline TopAxes in_world(const Columns<double>& b, const Matrix3d& world, double orientation) {
  return polished(product(world, vector(b.lead)), product(world, vector(b.next)), orientation);
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
  const Columns b = columns(top.series_, f.orientation, 0.0);
  const Matrix3d start = matrix(polished(vector(b.lead), vector(b.next), f.orientation), top.axes_);
  top.world_ = matrix(polished(product(R, start.row(2)), product(R, start.row(0)), 1), {2, 0, 1});
  return top;
}

Matrix3d AsymmetricTop::rotation(double tau) const {
  return matrix(in_world(columns(series_, orientation_, tau), world_, orientation_), axes_);
}

TopState AsymmetricTop::at(double tau) const {
  const Columns b = columns(series_, orientation_, tau);
  const TopAxes a = in_world(b, world_, orientation_);
  const double u = rates_[0] * b.lead[2];
  const double v = rates_[1] * b.next[2];
  const double w = rates_[2] * b.last_z;
  return {matrix(a, axes_), u * a.first + v * a.second + w * a.third,
          (euler_[0] * v * w) * a.first + (euler_[1] * w * u) * a.second + (euler_[2] * u * v) * a.third};
}

TurnedAngles AsymmetricTop::turned(double tau) const {
  const TurnedAngles sum = integral(tau, std::max(bounds_.omega, series_.rate), [this](double before, double after) {
    return angular_velocities(series_, orientation_, rates_, Lanes{before, after});
  });
  TurnedAngles turned{product(world_, {sum.world.x(), sum.world.y(), mean_rate_ * tau}), {}};
  for (int i = 0; i < 3; ++i) turned.body[axes_[i]] = sum.body[i];
  return turned;
}

}  // namespace ed::internal
