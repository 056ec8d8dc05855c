#pragma once

/// The gauge of two bodies of revolution: g_n(t), its rate, and a bound of how fast that rate can fall.
///
/// A gauge, as `certified_contact` wants it, has
///   State at(t)                           the pair at time t
///   Gap gap(state, n)                     g, and what its rate needs
///   Evaluation complete(state, gap, n)    g and the Newton step of n; evaluate(state, n) is both at once
///   double rate(state, gap or e, n)       dg/dt at fixed n
///   Certificate certificate(state, e, n)  with curvature(tau) >= -d2g/dt2 at fixed n over [t, t + tau]
///   Vector3d cold_normal(state)
///   bool separating_normal(state, n)      the fallback: a normal with g > 0 (to rounding), or false: an overlap
///   double curvature_limit()              >= -d2g/dt2 for every n and t
///   double size(), certified_depth(), speed(), and window(t_begin, t_end)

#include "axis_motion.h"
#include "select.h"
#include "sphere_window.h"

#include <ed/tolerances.h>

#include <geom/internal/perram_wertheim.h>
#include <geom/internal/uniaxial.h>

#include <Eigen/Core>

#include <cmath>

namespace ed::internal {

using geom::internal::Spheroid;
using geom::internal::UniaxialEvaluation;

/// An upper bound over tau' in [0, tau] of d2h/dt2, h = h(n, u(t + tau')) the support function of one body at fixed n.
///
/// With x = n.u, C = n.e0 and c = a^2 - b^2 the axis moves so that xdd = -Omega^2 (x - C), and
///
///     h'' = (c Omega^2 / h) [b^2 (r^2 - (x-C)^2) / h^2 - x (x-C)],   r^2 = (x-C)^2 + xd^2 / Omega^2,
///
/// h^2 = b^2 + c x^2. |xdd| <= Omega^2 r bounds the reach of x over tau; the bracket is then taken at its worst end.
template <bool kSpin>
struct SupportCurvature {
  double x;       ///< n.u
  double xd;      ///< n.du/dt
  double rate;    ///< Omega
  double centre;  ///< C = n.e0; used with spin only

  double bound(const Spheroid& S, double tau) const {
    if constexpr (kSpin) {
      return bound_spinning(S, tau);
    } else {
      return bound_across(S, tau);
    }
  }

 private:
  /// Without spin C = 0 and h'' depends on s = x^2 alone: falling in s for a rod (c > 0), rising for a disc.
  double bound_across(const Spheroid& S, double tau) const {
    const double rate2 = rate * rate;
    const double r2 = smaller(1.0, x * x + xd * xd / (rate2 + 1e-300));
    const double r = std::sqrt(r2);
    const double magnitude = std::abs(x);
    const double outward = std::copysign(1.0, x) * xd;  // d|x|/dt; at x = 0 either sign is covered below
    // |x| after tau under the strongest pull towards (and beyond) zero; negative: it may have passed zero.
    const double end = magnitude + tau * (outward - 0.5 * rate2 * r * tau);
    const double low = larger(0.0, smaller(magnitude, end));
    const double s_low = low * low;
    if (S.c > 0) {
      const double h2 = S.b2 + S.c * s_low;
      return S.c * rate2 * (S.b2 * (r2 - s_low) - s_low * h2) / (h2 * std::sqrt(h2));
    }
    const double high = smaller(r, larger(magnitude + larger(0.0, outward) * tau, -end));
    const double s_high = high * high;
    const double h2_low = S.b2 + S.c * s_low;
    const double h_high = std::sqrt(larger(S.a2, S.b2 + S.c * s_high));
    return -S.c * rate2 * (s_high / h_high - S.b2 * (r2 - s_high) / (h2_low * std::sqrt(h2_low)));
  }

  /// With spin each factor is taken at its own worst end over the reach [low, high] of x.
  double bound_spinning(const Spheroid& S, double tau) const {
    const double rate2 = rate * rate;
    const double offset = x - centre;
    const double r2 = offset * offset + xd * xd / (rate2 + 1e-300);
    const double r = std::sqrt(r2);
    const double swing = 0.5 * rate2 * r * tau * tau;
    const double low = larger(centre - r, x + smaller(0.0, xd) * tau - swing);
    const double high = smaller(centre + r, x + larger(0.0, xd) * tau + swing);
    const double x2_max = smaller(1.0, larger(low * low, high * high));
    const double x2_min = low * high <= 0 ? 0 : smaller(low * low, high * high);
    const double at_low = low * (low - centre);
    const double at_high = high * (high - centre);
    const double off2_max = larger((low - centre) * (low - centre), (high - centre) * (high - centre));
    const double off2_min = (low - centre) * (high - centre) <= 0
                                ? 0
                                : smaller((low - centre) * (low - centre), (high - centre) * (high - centre));
    if (S.c > 0) {
      const double h2_min = S.b2 + S.c * x2_min;
      const double h_min = std::sqrt(h2_min);
      const double middle = 0.5 * centre;  // where x (x - C) is least
      const double product = low <= middle && middle <= high ? -middle * middle : smaller(at_low, at_high);
      const double pull = -product;
      const double h_pull = pull > 0 ? h_min : std::sqrt(S.b2 + S.c * x2_max);
      return S.c * rate2 * (S.b2 * larger(0.0, r2 - off2_min) / (h2_min * h_min) + pull / h_pull);
    }
    const double h_min = std::sqrt(larger(S.a2, S.b2 + S.c * x2_max));
    const double h2_max = S.b2 + S.c * x2_min;
    const double h_max = std::sqrt(h2_max);
    const double product = larger(at_low, at_high);
    return -S.c * rate2 *
           (product / (product > 0 ? h_min : h_max) - S.b2 * larger(0.0, r2 - off2_max) / (h2_max * h_max));
  }
};

/// Axis and its rate of change at time t.
template <bool kSpin>
void turn(const AxisMotion& m, double t, Eigen::Vector3d& u, Eigen::Vector3d& du) {
  const double dt = t - m.time;
  if (dt == 0) {  // a body that has just collided: no sine needed
    u = kSpin ? Eigen::Vector3d(m.e0 + m.e1) : m.e1;
    du = m.rate * m.e2;
    return;
  }
  const SinCos sc = sincos(m.rate * dt);
  u = sc.cos * m.e1 + sc.sin * m.e2;
  if constexpr (kSpin) u += m.e0;
  du = m.rate * (sc.cos * m.e2 - sc.sin * m.e1);
}

template <bool kSpin>
SupportCurvature<kSpin> support_curvature(const AxisMotion& m, const Eigen::Vector3d& du, double x,
                                          const Eigen::Vector3d& n) {
  return {x, du.dot(n), m.rate, kSpin ? m.e0.dot(n) : 0.0};
}

template <bool kSpin>
class UniaxialGauge {
 public:
  struct State {
    Eigen::Vector3d r, u_a, u_b, du_a, du_b;
  };
  using Gap = geom::internal::UniaxialGap;
  using Evaluation = UniaxialEvaluation;

  struct Certificate {
    const UniaxialGauge& gauge;
    SupportCurvature<kSpin> a, b;
    double curvature(double tau) const { return a.bound(gauge.A_, tau) + b.bound(gauge.B_, tau); }
  };

  /// `r_now`: the vector from A's centre to B's at `now`, in the image that is meant. `reach`: sum of the bounding
  /// radii.
  UniaxialGauge(const Spheroid& A, const AxisMotion& a, const Spheroid& B, const AxisMotion& b,
                const Eigen::Vector3d& r_now, double now, double reach)
      : A_(A), B_(B), a_(a), b_(b), r_now_(r_now), v_(b.velocity - a.velocity), now_(now), reach_(reach) {}

  State at(double t) const {
    State s;
    s.r = r_now_ + (t - now_) * v_;
    turn<kSpin>(a_, t, s.u_a, s.du_a);
    turn<kSpin>(b_, t, s.u_b, s.du_b);
    return s;
  }

  Gap gap(const State& s, const Eigen::Vector3d& n) const {
    return geom::internal::uniaxial_gap(A_, B_, s.r, s.u_a, s.u_b, n);
  }

  Evaluation complete(const State& s, const Gap& gap, const Eigen::Vector3d& n) const {
    return geom::internal::uniaxial_step(A_, B_, s.r, s.u_a, s.u_b, n, gap);
  }

  Evaluation evaluate(const State& s, const Eigen::Vector3d& n) const { return complete(s, gap(s, n), n); }

  template <class GapOrEvaluation>
  double rate(const State& s, const GapOrEvaluation& e, const Eigen::Vector3d& n) const {
    return v_.dot(n) - e.lever[0] * s.du_a.dot(n) - e.lever[1] * s.du_b.dot(n);
  }

  Certificate certificate(const State& s, const UniaxialEvaluation& e, const Eigen::Vector3d& n) const {
    return {*this, support_curvature<kSpin>(a_, s.du_a, e.x[0], n), support_curvature<kSpin>(b_, s.du_b, e.x[1], n)};
  }

  Eigen::Vector3d cold_normal(const State& s) const { return geom::internal::cold_normal(A_, B_, s.r, s.u_a, s.u_b); }

  /// The normal of the Perram-Wertheim contact function, or false if the bodies overlap, by more than the rounding
  /// error of that function: g(normal) = (sqrt(F) - 1)(hA + hB).
  bool separating_normal(const State& s, Eigen::Vector3d& n) const {
    const auto contact = geom::internal::perram_wertheim(quadric(A_, s.u_a), quadric(B_, s.u_b), s.r);
    if (!(contact.F > 1 - 2 * kOverlap)) return false;
    n = contact.normal;
    return true;
  }

  Window window(double t_begin, double t_end) const { return sphere_window(r_now_, v_, reach_, now_, t_begin, t_end); }

  /// A bound of -d2g/dt2 for every n and t, cheap and crude. From the formula of SupportCurvature, with y = x - C: for
  /// a rod h >= b, and the bracket is at most r^2 - 2 y^2 - C y <= r^2 + C^2 / 8 <= 1; for a disc h >= a, and x y <= 1.
  double curvature_limit() const {
    return A_.turning_limit * (a_.rate * a_.rate) + B_.turning_limit * (b_.rate * b_.rate);
  }

  double size() const { return reach_; }
  double certified_depth() const { return A_.rho + B_.rho; }
  /// An upper bound of |dd/dt|.
  double speed() const { return v_.norm() + reach_ * (a_.rate + b_.rate); }

 private:
  static Eigen::Matrix3d quadric(const Spheroid& S, const Eigen::Vector3d& u) {
    return S.b2 * Eigen::Matrix3d::Identity() + S.c * u * u.transpose();
  }

  const Spheroid& A_;
  const Spheroid& B_;
  const AxisMotion& a_;
  const AxisMotion& b_;
  Eigen::Vector3d r_now_;
  Eigen::Vector3d v_;
  double now_;
  double reach_;
};

}  // namespace ed::internal
