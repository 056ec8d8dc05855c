#pragma once

/// The pair gap of two bodies of revolution: g_n(t), its rate, and a bound of how fast that rate can fall.
///
/// A pair gap is the gap g of two moving bodies along a normal n as a function of time, in the form that
/// certified_contact needs. It is a class with
///   State at(t)                           the pair at time t, with what rounding may hide in `rounding` (rounding.h)
///   Sample sample(state, n)                     g, with what its rate needs
///   Evaluation complete(state, gap, n)    g and the Newton step of n; evaluate(state, n) is both at once
///   double rate(state, gap or e, n)       dg/dt at fixed n
///   Certificate certificate(state, e, n)  with curvature(tau) >= -d2g/dt2 at fixed n over [t, t + tau]
///   Vector3d cold_normal(state)
///   separating_normal(state, n)           the fallback: see separation.h
///   double curvature_limit()              >= -d2g/dt2 for every n and t
///   double rate_slope()                   >= |d2g/dt dn| for every n and t
///   double size(), certified_depth(), speed(), and window(t_begin, t_end)

#include "base/select.h"
#include "contact/pair_gap_base.h"
#include "contact/rounding.h"
#include "contact/separation.h"
#include "contact/sphere_window.h"
#include "contact/support_curvature.h"
#include "motion/axis_motion.h"

#include <ed/tolerances.h>

#include <geom/kernel/perram_wertheim.h>
#include <geom/kernel/uniaxial.h>

#include <Eigen/Core>

#include <cmath>

namespace ed::internal {

using geom::kernel::Spheroid;
using geom::kernel::UniaxialEvaluation;

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

/// `reach`: sum of the bounding radii.
inline PairScalesOf<double> pair_scales(const Spheroid& A, const AxisMotion& a, const Spheroid& B, const AxisMotion& b,
                                        double now, double reach) {
  const double rate_a = a.axis_rate();
  const double rate_b = b.axis_rate();
  return {.size = reach,
          .places = sum_of_magnitudes(a.position) + sum_of_magnitudes(b.position),
          .speed = sum_of_magnitudes(a.velocity) + sum_of_magnitudes(b.velocity),
          .surface_speed = reach * (rate_a + rate_b),
          .bending = A.turning_limit * rate_a + B.turning_limit * rate_b,
          .limit = A.turning_limit * (rate_a * rate_a) + B.turning_limit * (rate_b * rate_b),
          .origin = larger(std::abs(now), larger(std::abs(a.time), std::abs(b.time)))};
}

template <bool kSpin>
class UniaxialGap : private PairGapBase<geom::kernel::Spheroid, AxisMotion> {
 public:
  struct State {
    Eigen::Vector3d r, u_a, u_b, du_a, du_b;
    Rounding rounding;
  };
  using Sample = geom::kernel::UniaxialSample;
  using Evaluation = UniaxialEvaluation;

  struct Certificate {
    const UniaxialGap& gap;
    SupportCurvature<kSpin> a, b;
    double curvature(double tau) const { return a.bound(gap.A_, tau) + b.bound(gap.B_, tau); }
  };

  /// `r_now`: the vector from A's centre to B's at `now`, in the image that is meant. `reach`: sum of the bounding
  /// radii.
  UniaxialGap(const Spheroid& A, const AxisMotion& a, const Spheroid& B, const AxisMotion& b,
              const Eigen::Vector3d& r_now, double now, double reach)
      : PairGapBase(A, a, B, b, r_now, now), scales_(pair_scales(A, a, B, b, now, reach)) {}

  State at(double t) const {
    State s;
    s.r = r_at(t);
    turn<kSpin>(a_, t, s.u_a, s.du_a);
    turn<kSpin>(b_, t, s.u_b, s.du_b);
    s.rounding = scales_.rounding(t);
    return s;
  }

  Sample sample(const State& s, const Eigen::Vector3d& n) const {
    return geom::kernel::uniaxial_gap(A_, B_, s.r, s.u_a, s.u_b, n);
  }

  Evaluation complete(const State& s, const Sample& sample, const Eigen::Vector3d& n) const {
    return geom::kernel::uniaxial_step(A_, B_, s.r, s.u_a, s.u_b, n, sample);
  }

  Evaluation evaluate(const State& s, const Eigen::Vector3d& n) const { return complete(s, sample(s, n), n); }

  template <class SampleOrEvaluation>
  double rate(const State& s, const SampleOrEvaluation& e, const Eigen::Vector3d& n) const {
    return gap_rate(v_, s.du_a, s.du_b, e.lever, n);
  }

  Certificate certificate(const State& s, const UniaxialEvaluation& e, const Eigen::Vector3d& n) const {
    return {*this, support_curvature<kSpin>(a_, s.du_a, e.x[0], n), support_curvature<kSpin>(b_, s.du_b, e.x[1], n)};
  }

  Eigen::Vector3d cold_normal(const State& s) const { return geom::kernel::cold_normal(A_, B_, s.r, s.u_a, s.u_b); }

  /// The normal of the Perram-Wertheim contact function, or false if the bodies overlap, by more than the rounding
  /// error of that function: g(normal) = (sqrt(F) - 1)(hA + hB).
  Separation separating_normal(const State& s, Eigen::Vector3d& n) const {
    const auto contact = geom::kernel::perram_wertheim(quadric(A_, s.u_a), quadric(B_, s.u_b), s.r);
    if (!(contact.F > 1 - 2 * kOverlap)) return Separation::overlapping;
    n = contact.normal;
    return Separation::apart;
  }

  Window window(double t_begin, double t_end) const { return sphere_window(r_now_, v_, size(), now_, t_begin, t_end); }

  /// A bound of -d2g/dt2 for every n and t, cheap and crude. From the formula of SupportCurvature, with y = x - C: for
  /// a rod h >= b, and the bracket is at most r^2 - 2 y^2 - C y <= r^2 + C^2 / 8 <= 1; for a disc h >= a, and x y <= 1.
  double curvature_limit() const { return scales_.limit; }

  /// g' = n.v - sum of lever (n.du), and |d lever / dn| |n.du| and |lever| |du| are at most L Omega.
  double rate_slope() const { return v_.norm() + 2 * scales_.bending; }

  double size() const { return scales_.size; }
  double certified_depth() const { return A_.rho + B_.rho; }
  /// An upper bound of |dd/dt|.
  double speed() const { return v_.norm() + scales_.surface_speed; }

 private:
  static Eigen::Matrix3d quadric(const Spheroid& S, const Eigen::Vector3d& u) {
    return S.b2 * Eigen::Matrix3d::Identity() + S.c * u * u.transpose();
  }

  PairScalesOf<double> scales_;
};

}  // namespace ed::internal
