#pragma once

/// The pair gap of two rods (uniaxial_gap.h defines pair gaps). The best normal has a closed form.

#include "contact/curvature_steps.h"
#include "contact/pair_gap_base.h"
#include "contact/rods/choices.h"
#include "contact/rods/pair.h"
#include "contact/rods/rod.h"
#include "contact/separation.h"
#include "contact/sphere_window.h"
#include "contact/uniaxial_gap.h"
#include "motion/axis_motion.h"

#include <ed/tolerances.h>

#include <geom/kernel/dual_newton.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ed::internal {

template <bool kSpin>
class RodGap : private PairGapBase<Rod, AxisMotion> {
 public:
  using Vector = Eigen::Vector3d;
  using Pair = RodPairOf<double, Vector, kSpin>;
  using Turn = RodTurnOf<double, Vector, kSpin>;
  struct State : Pair {
    Rounding rounding;
  };
  using Sample = RodSampleOf<double>;
  struct Evaluation : geom::kernel::Evaluation {
    Sample sample;
    RodPointsOf<double> points;  ///< closest points of the axes; support points until they are known
    double distance;             ///< distance of these
  };

  /// `r_now`: the vector from A's centre to B's at `now`, in the image that is meant.
  RodGap(const Rod& A, const AxisMotion& a, const Rod& B, const AxisMotion& b, const Vector& r_now, double now)
      : PairGapBase(A, a, B, b, r_now, now),
        scales_(rod_scales(A.half_length, B.half_length, a.axis_rate(), b.axis_rate(), size(),
                           sum_of_magnitudes(a.position) + sum_of_magnitudes(b.position),
                           sum_of_magnitudes(a.velocity) + sum_of_magnitudes(b.velocity),
                           larger(std::abs(now), larger(std::abs(a.time), std::abs(b.time))))),
        speed_(v_.norm() + scales_.bending) {}

  State at(double t) const {
    State s;
    s.a = A_.half_length;
    s.b = B_.half_length;
    s.balls = A_.radius + B_.radius;
    s.r = r_at(t);
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

  /// Returns what a sample tells: `ascend` finds the closest points.
  Evaluation complete(const State& s, const Sample& sample, const Vector& /*n*/) const {
    Evaluation e;
    e.g = sample.g;
    e.decrement = std::numeric_limits<double>::infinity();
    e.step2 = e.decrement;
    e.step.setZero();
    e.sample = sample;
    e.points = {std::copysign(s.a, sample.x_a), -std::copysign(s.b, sample.x_b), 0, 0};  // ends need no angle
    e.distance = s.between(e.points).norm();
    return e;
  }
  Evaluation evaluate(const State& s, const Vector& n) const { return complete(s, sample(s, n), n); }

  /// Returns dd/dt: the closest points move with their rods.
  double rate(const State& s, const Evaluation& e, const Vector& n) const { return s.between_rate(e.points).dot(n); }
  double contact_rate(const State& s, const Evaluation& e, const Vector& n) const { return rate(s, e, n); }

  bool clears(const State& s, const Sample& sample, const Vector& n, double horizon) const {
    return s.clears(sample, n, s.rounding, horizon);
  }
  bool clears(const State& s, const Evaluation& e, const Vector& n, double horizon) const {
    return clears(s, e.sample, n, horizon);
  }

  /// Takes the closest points; false if their direction drowns in rounding.
  bool solve(const State& s, Vector& n, Evaluation& e) const {
    const RodPointsOf<double> points = s.closest_points();
    const Vector between = s.between(points);
    const double distance = std::sqrt(between.squaredNorm());
    if (!(distance > kLeastRodDistance * s.balls)) return false;
    n = s.normal(points, between, distance);
    e.sample = s.sample(n);
    // What lies between both bounds is rounding: rods that may only touch do not overlap.
    const double upper = distance - s.balls;
    e.g = e.sample.g < 0 ? smaller(0.0, larger(e.sample.g, upper)) : e.sample.g;
    e.decrement = 2 * larger(0.0, upper - e.g);
    e.step2 = 0;
    e.step.setZero();
    e.points = points;
    e.distance = distance;
    return true;
  }

  template <class Done>
  geom::kernel::Ascent ascend(const State& s, const Done& done, int& budget, Vector& n, Evaluation& e) const {
    --budget;
    if (!solve(s, n, e)) return geom::kernel::Ascent::stalled;
    (void)done(e);
    return geom::kernel::Ascent::converged;
  }
  bool settled(const Evaluation& e) const { return e.step2 == 0; }

  double certified_step(const State& s, const Evaluation& e, const Vector& n, double g, double gp,
                        double horizon) const {
    // A step after which Newton's method is tried is long enough.
    const auto enough = [&](double tau) { return tau >= horizon || (gp < 0 && worth_refining(gp, -g / gp - tau)); };
    return rod_step(static_cast<const Pair&>(s), e.points, e.distance, n, g, lift(s, e, g), s.rounding, size(), speed_,
                    horizon, enough, curvature_share_);
  }

  double least_step(const State& s, const Evaluation& e, const Vector& n, bool touching, double tau) const {
    return least_clear_step(size() / speed_, s.rounding.gap, touching, tau,
                            [&](const auto& has) { return any_choice(s, e, n, 1, has); });
  }
  bool worth_refining(double /*gp*/, double spread) const { return spread <= kTangentAgreement * (size() / speed_); }

  /// Whether the distance, 0 now, certainly was positive all the time `span` before: the same parabolas hold backwards
  /// in time, from g = 0 on.
  bool falls_since(const State& s, const Evaluation& e, const Vector& n, double rate, double span) const {
    if (!(rate < -kResting * speed_)) return false;
    if (!(span > 0)) return true;
    return is_clear_for(span, size() / speed_, s.rounding.gap,
                        [&](const auto& has) { return any_choice(s, e, n, -1, has); });
  }

  Vector cold_normal(const State& s) const {
    return s.r.squaredNorm() > 0 ? Vector(s.r.stableNormalized()) : Vector::UnitX();
  }
  /// Returns the only answer for rods whose closest points tell no direction: their axes meet.
  Separation separating_normal(const State& /*s*/, Vector& /*n*/) const { return Separation::overlapping; }
  Window window(double t_begin, double t_end) const { return sphere_window(r_now_, v_, size(), now_, t_begin, t_end); }
  double size() const { return (A_.half_length + A_.radius) + (B_.half_length + B_.radius); }
  double certified_depth() const { return A_.radius + B_.radius; }
  double speed() const { return speed_; }

 protected:
  double curvature_share_ = 1;  ///< RodTurnOf::share

 private:
  /// Returns by how much the parabolas of rods that touch begin above the sample, which rounding has made negative.
  static double lift(const State& s, const Evaluation& e, double g) {
    return smaller(2 * s.rounding.gap, g - e.sample.g);
  }

  /// Returns whether some choice of a turning normal has the property: with the closest points, fixed, or with a rod.
  template <class Property>
  bool any_choice(const State& s, const Evaluation& e, const Vector& n, double direction, const Property& has) const {
    const auto with_rod = [&](const Vector& u, const Vector& du) { return Vector(du * u.dot(n) - du.dot(n) * u); };
    const std::array<Vector, 4> choices{s.turning(e.points, e.distance, n), Vector::Zero(), with_rod(s.u_a, s.du_a),
                                        with_rod(s.u_b, s.du_b)};
    return std::any_of(choices.begin(), choices.end(), [&](const Vector& dn) {
      return has(Turn(s, n, dn, s.rounding, size(), direction, curvature_share_));
    });
  }

  PairScalesOf<double> scales_;
  double speed_;
};

}  // namespace ed::internal
