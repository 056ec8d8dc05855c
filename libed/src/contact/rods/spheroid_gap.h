#pragma once

/// The pair gap of an ellipsoid of revolution, A, and a rod, B (uniaxial_gap.h defines pair gaps).

#include "contact/curvature_steps.h"
#include "contact/pair_gap_base.h"
#include "contact/rods/choices.h"
#include "contact/rods/rod.h"
#include "contact/rods/spheroid_pair.h"
#include "contact/separation.h"
#include "contact/sphere_window.h"
#include "contact/uniaxial_gap.h"
#include "motion/axis_motion.h"

#include <ed/tolerances.h>

#include <geom/kernel/dual_newton.h>
#include <geom/kernel/uniaxial.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>

namespace ed::internal {

/// An ellipsoid of revolution with the radii that its pair gap needs.
struct SpheroidBody {
  const geom::kernel::Spheroid& shape;
  double bounding_radius;
  double inscribed_radius;
};

/// Raises sigma where Newton's matrix of an ellipsoid and a rod is not definite, as for two ellipsoids.
class MixedLift {
 public:
  MixedLift(double g, double rho) : g_(g), rho_(rho) {}
  double operator()(double sigma, double t1) const { return geom::kernel::lifted(g_, rho_, sigma, t1, 0); }

 private:
  double g_, rho_;
};

/// Evaluation of a normal: the Newton step with the values that its rate needs.
struct MixedEvaluation : geom::kernel::Evaluation {
  MixedSampleOf<double> sample;
  double s;  ///< closest point of the rod
};

/// Completes an evaluation: computes the Newton step of n.
template <class Pair>
MixedEvaluation complete_mixed(const Pair& pair, const MixedSampleOf<double>& sample, const Eigen::Vector3d& n) {
  const auto step = pair.step(sample, n, MixedLift(sample.g, pair.shape.rho + pair.radius));
  MixedEvaluation e;
  e.g = sample.g;
  e.decrement = step.decrement;
  set_step(e, step.delta, step.delta2);
  e.sample = sample;
  e.s = step.s;
  return e;
}

/// Returns the unit vector of MixedPairOf::nearest_in_quadric; A's axis if the rod goes through A's centre.
template <class Pair>
Eigen::Vector3d normal_in_quadric(const Pair& pair, double ball2, bool& inside) {
  return geom::kernel::unit_or(pair.nearest_in_quadric(ball2, inside), pair.u_a);
}

/// Returns the normal to start from: exact where the rod is a ball beside a ball.
template <class Pair>
Eigen::Vector3d mixed_cold_normal(const Pair& pair) {
  bool inside = false;
  return normal_in_quadric(pair, pair.radius * pair.radius, inside);
}

template <bool kSpin>
class MixedGap {
 public:
  using Vector = Eigen::Vector3d;
  using Pair = MixedPairOf<double, Vector, geom::kernel::Spheroid, kSpin>;
  using Turn = MixedTurnOf<double, Vector, geom::kernel::Spheroid, kSpin>;
  struct State : Pair {
    Rounding rounding;
  };
  using Sample = MixedSampleOf<double>;
  using Evaluation = MixedEvaluation;

  /// `r_now`: the vector from A's centre to B's at `now`, in the image that is meant.
  MixedGap(const SpheroidBody& A, const AxisMotion& a, const Rod& B, const AxisMotion& b, const Vector& r_now,
           double now)
      : A_(A),
        B_(B),
        a_(a),
        b_(b),
        r_now_(r_now),
        v_(b.velocity - a.velocity),
        now_(now),
        scales_(mixed_scales(A.shape.turning_limit, B.half_length, a.axis_rate(), b.axis_rate(), size(),
                             sum_of_magnitudes(a.position) + sum_of_magnitudes(b.position),
                             sum_of_magnitudes(a.velocity) + sum_of_magnitudes(b.velocity),
                             larger(std::abs(now), larger(std::abs(a.time), std::abs(b.time))))),
        speed_(v_.norm() + (A.bounding_radius - A.inscribed_radius) * a.axis_rate() + B.half_length * b.axis_rate()) {}

  State at(double t) const {
    State s;
    s.shape = A_.shape;
    s.l = B_.half_length;
    s.radius = B_.radius;
    s.r = r_now_ + (t - now_) * v_;
    s.v = v_;
    turn<kSpin>(a_, t, s.u_a, s.du_a);
    turn<kSpin>(b_, t, s.u_b, s.du_b);
    if constexpr (kSpin) {
      s.e0_a = a_.e0;
      s.e0_b = b_.e0;
    }
    s.rate_a = a_.axis_rate();
    s.rate_b = b_.axis_rate();
    s.rounding = scales_.rounding(t);
    return s;
  }

  Sample sample(const State& s, const Vector& n) const { return s.sample(n); }
  Evaluation complete(const State& s, const Sample& sample, const Vector& n) const {
    return complete_mixed(s, sample, n);
  }
  Evaluation evaluate(const State& s, const Vector& n) const { return complete(s, sample(s, n), n); }

  /// Returns dd/dt: the closest point of the rod moves with it.
  double rate(const State& s, const Evaluation& e, const Vector& n) const { return s.rate(e.sample, n, e.s); }
  double contact_rate(const State& s, const Evaluation& e, const Vector& n) const { return rate(s, e, n); }

  bool clears(const State& s, const Sample& sample, const Vector& n, double horizon) const {
    return s.clears(sample, n, s.rounding, horizon);
  }
  bool clears(const State& s, const Evaluation& e, const Vector& n, double horizon) const {
    return clears(s, e.sample, n, horizon);
  }

  template <class Done>
  geom::kernel::Ascent ascend(const State& s, const Done& done, int& budget, Vector& n, Evaluation& e) const {
    const auto evaluate_at = [&](const Vector& m) { return evaluate(s, m); };
    return geom::kernel::ascend(evaluate_at, geom::kRoundingFactor * size(), done, budget, n, e);
  }
  bool settled(const Evaluation& e) const { return e.step2 <= geom::kNormalTolerance2; }

  double certified_step(const State& s, const Evaluation& e, const Vector& n, double g, double gp,
                        double horizon) const {
    // A step after which Newton's method is tried is long enough.
    const auto enough = [&](double tau) { return tau >= horizon || (gp < 0 && worth_refining(gp, -g / gp - tau)); };
    return mixed_step(static_cast<const Pair&>(s), e.sample, n, turning(s, e, n), g, lift(s, e, g), s.rounding, size(),
                      speed_, horizon, enough, curvature_share_);
  }

  double least_step(const State& s, const Evaluation& e, const Vector& n, bool touching, double tau) const {
    return least_clear_step(size() / speed_, s.rounding.gap, touching, tau,
                            [&](const auto& has) { return any_choice(s, e, n, 1, has); });
  }
  bool worth_refining(double /*gp*/, double spread) const { return spread <= kTangentAgreement * (size() / speed_); }

  /// Whether the distance, 0 now, certainly was positive all the time `span` before: see RodGap. By the normal that the
  /// Newton step leads to, whose gap is the distance to rounding.
  bool falls_since(const State& s, const Evaluation& last, const Vector& last_n, double rate, double span) const {
    if (!(rate < -kResting * speed_)) return false;
    if (!(span > 0)) return true;
    const Vector n = geom::kernel::step_on_sphere(last_n, last.step);
    const Evaluation e = evaluate(s, n);
    return is_clear_for(span, size() / speed_, s.rounding.gap,
                        [&](const auto& has) { return any_choice(s, e, n, -1, has); });
  }

  Vector cold_normal(const State& s) const { return mixed_cold_normal(s); }
  /// Returns whether the rod's axis enters A, in closed form. If not, the normal of the nearest point in A's metric has
  /// a gap above -R, above which g has one maximum.
  Separation separating_normal(const State& s, Vector& n) const {
    bool inside = false;
    const Vector normal = normal_in_quadric(s, 0, inside);
    if (inside) return Separation::overlapping;
    n = normal;
    return Separation::apart;
  }
  Window window(double t_begin, double t_end) const { return sphere_window(r_now_, v_, size(), now_, t_begin, t_end); }
  double size() const { return A_.bounding_radius + (B_.half_length + B_.radius); }
  double certified_depth() const { return A_.shape.rho + B_.radius; }
  double speed() const { return speed_; }

 protected:
  double curvature_share_ = 1;  ///< MixedTurnOf::share

 private:
  static MixedLift lift_of(const State& s, const Evaluation& e) { return {e.g, s.shape.rho + s.radius}; }
  static Vector turning(const State& s, const Evaluation& e, const Vector& n) {
    return s.turning(e.sample, n, e.s, lift_of(s, e));
  }
  /// Returns by how much the parabolas of bodies that touch begin above the sample, which rounding has made negative.
  static double lift(const State& s, const Evaluation& e, double g) {
    return smaller(2 * s.rounding.gap, g - e.sample.g);
  }

  /// Returns whether some choice of a turning normal has the property: the best normal's, fixed, or with a body.
  template <class Property>
  bool any_choice(const State& s, const Evaluation& e, const Vector& n, double direction, const Property& has) const {
    const auto with_axis = [&](const Vector& u, const Vector& du) { return Vector(du * u.dot(n) - du.dot(n) * u); };
    const std::array<Vector, 4> choices{turning(s, e, n), Vector::Zero(), with_axis(s.u_a, s.du_a),
                                        with_axis(s.u_b, s.du_b)};
    return std::any_of(choices.begin(), choices.end(), [&](const Vector& dn) {
      return has(Turn(s, e.sample, n, dn, s.rounding, size(), direction, curvature_share_));
    });
  }

  SpheroidBody A_;
  const Rod& B_;
  const AxisMotion& a_;
  const AxisMotion& b_;
  Vector r_now_, v_;
  double now_;
  PairScalesOf<double> scales_;
  double speed_;
};

}  // namespace ed::internal
