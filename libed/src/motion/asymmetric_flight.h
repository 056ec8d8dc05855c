#pragma once

/// Flight of a body with three different moments: its constants, bounds of its angular velocity, and quadrature along
/// it. Included by asymmetric_top.cpp alone.

#include "motion/asymmetric_top.h"
#include "motion/elliptic.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Squares below this, relative to the largest moment and component of omega, are treated as zero.
constexpr double kVanishing = 1e-270;

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

/// Returns the integral of f, which is asked for two values at a time, over [0, tau] by Gauss-Legendre rules on pieces
/// of at most 1 / rate, the rate of the motion. The poles of a top's motion lie (pi/2) / rate or farther from the real
/// axis: at u = i K', K' >= pi/2, and p
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
      for (const TurnedAngles& at : f(middle - half * node, middle + half * node)) {
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
  if (f.D3 < kVanishing || term3 + term1 < kVanishing) return std::nullopt;
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

}  // namespace
}  // namespace ed::internal
