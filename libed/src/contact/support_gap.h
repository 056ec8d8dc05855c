#pragma once

/// The pair gap of two superellipsoids or ellipsoids with any semi-axes and moments of inertia (uniaxial_gap.h
/// defines pair gaps), and the steps it certifies.
///
/// The second derivative of a support function at fixed n has no bound where a face is flat, so that
/// certified_contact's parabola cannot be made of one number K. Instead:
///
/// Majorants. At the support point each body is held in an ellipsoid (geom/kernel/norm_bodies.h) so that for every
/// change dm of the direction seen from the body
///
///     h(m + dm) <= h + c + s.dm + |D dm|^2 / (2 h).
///
/// Moving normals. Let n turn at a constant Omega, and let the body turn at omega(t). In axes that turn with the body
/// (and agree with the world's now) the direction is u(tau) with u(0) = n and, Delta = Omega - omega,
///
///     u' = mu1 = Delta x n,   u'' = mu2 = Delta x (Omega x n) - omega x mu1 - alpha x n,   |u'''| <= M3,
///     M3 = |Delta| (|Omega| + |omega|)^2 + 3 |alpha| (|Omega| + |omega|) + |jerk|,
///
/// alpha and jerk the derivatives of omega, all lengths at their largest in [0, tau]. So dm = mu1 tau + mu2 tau^2/2 +
/// R, |R| <= M3 tau^3/6, and h(tau') <= h + c + s.mu1 tau' + K tau'^2/2 for tau' <= tau with
///
///     K(tau) = s.mu2 + |s| M3 tau/3 + (|D mu1| + |D mu2| tau/2 + max(D) M3 tau^2/6)^2 / h.
///
/// The centres: for f = n.(r + v tau), f'' = (Omega x (Omega x n)).r + 2 (Omega x n).v now, and |f'''| <= |Omega|
/// |Omega x n| (|Omega| |r + v tau| + 3 |v|). Together g(tau') >= g - c + g' tau' - K tau'^2/2 on [0, tau]: the
/// parabola of certified_contact, for one pair of Omega and c. Any Omega will do; tried are 0 and that of the best
/// normal, which follows a flat face; where the bodies are flat at n, c > 0 (a share of g) and c = 0. The longest step
/// is taken.
///
/// Tilted ends. A support function is convex, so that with m = n + tau mu1, the direction at the end to first order,
/// and theta = tau'/tau,
///
///     h(tau') <= (1 - theta) h(n) + theta h(m) + ((|Omega| + |omega|)^2 + |alpha|) R tau'^2/2,
///
/// R the bounding radius, and f >= f(0) + f' tau' - |Omega| (|Omega| |r + v tau| + 2 |v|) tau'^2/2. If g >= 0 now and
/// at the tilted end, the last terms included, there is no contact before tau: first order on faces, but it does not
/// need g > 0 to see two faces part. Tried are Omega = 0, that of the best normal, and those of the bodies, whose flat
/// faces then do not tilt at all.

#include "base/select.h"
#include "contact/curvature_steps.h"
#include "contact/pair_gap_base.h"
#include "contact/rounding.h"
#include "contact/separation.h"
#include "contact/sphere_window.h"
#include "motion/rigid_motion.h"

#include <ed/tolerances.h>

#include <geom/kernel/dual_newton.h>
#include <geom/kernel/norm_body_pair.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace ed::internal {

/// A shape as SupportGap needs it.
struct NormBodyShape {
  geom::kernel::NormShape norm;
  double bounding_radius;
  double inscribed_radius;
  double lever;       ///< turning_lever (body_shapes.h)
  bool has_vertices;  ///< some exponent is above 1
};

/// |delta|^2 of a settled normal where a body has vertices. There g is so flat that decrement and |delta|^2, which a
/// quadratic model tells, are small long before the normal is right: with geom::kNormalTolerance2, 1e-12, gaps of 1e-12
/// were taken for contacts (decision 020).
inline constexpr double kVertexStep2 = 1e-18;

class SupportGap : private PairGapBase<NormBodyShape, RigidMotion> {
 public:
  using DualSample = geom::kernel::DualSample;
  using LaneVector = geom::kernel::LaneVector;
  using Lanes = geom::kernel::Lanes;
  using NormBodies = geom::kernel::NormBodies;
  using NormBodyPair = geom::kernel::NormBodyPair;

  struct State {
    NormBodyPair pair;
    LaneVector omega, alpha;
    GeneralRounding rounding;
  };
  struct Sample {
    double g;
    DualSample dual;
  };
  struct Evaluation : geom::kernel::Evaluation {
    DualSample sample;
    NormBodyPair::Step newton;
  };

  /// `r_now`: the vector from A's centre to B's at `now`, in the image that is meant.
  SupportGap(const NormBodyShape& A, const RigidMotion& a, const NormBodyShape& B, const RigidMotion& b,
             const Eigen::Vector3d& r_now, double now)
      : PairGapBase(A, a, B, b, r_now, now),
        scales_(GeneralScales::of(A.bounding_radius, a, B.bounding_radius, b, now)),
        settled_step2_(A.has_vertices || B.has_vertices ? kVertexStep2 : geom::kNormalTolerance2) {}

  State at(double t) const {
    const TopState top_a = a_.top.at(t - a_.time);
    const TopState top_b = b_.top.at(t - b_.time);
    return {NormBodyPair(NormBodies(A_.norm, top_a.R, B_.norm, top_b.R), r_at(t), size(),
                         A_.inscribed_radius + B_.inscribed_radius),
            LaneVector::of(top_a.omega, top_b.omega), LaneVector::of(top_a.alpha, top_b.alpha), scales_.rounding(t)};
  }

  Sample sample(const State& s, const Eigen::Vector3d& n) const {
    const DualSample sample = s.pair.sample(n);
    return {sample.g, sample};
  }
  Evaluation complete(const State& s, const Sample& sample, const Eigen::Vector3d& /*n*/) const {
    return evaluation(s, sample.dual);
  }
  Evaluation evaluate(const State& s, const Eigen::Vector3d& n) const { return evaluation(s, s.pair.sample(n)); }

  /// dg/dt at fixed n: support points move with their bodies, to first order.
  double rate(const State& s, const Evaluation& e, const Eigen::Vector3d& n) const {
    return n.dot(v_) - point_rate(s, e.sample.support.point, n);
  }
  /// Returns the rate at the contact. On a flat face the support point is lost to rounding, and the sign must be that
  /// of the impulse (contact_points).
  double contact_rate(const State& s, const Evaluation& e, const Eigen::Vector3d& n) const {
    return n.dot(v_) - point_rate(s, contact_points(s, e.sample, e.newton), n);
  }

  /// The points of both bodies, from their centres, at which they touch; apart by g n exactly.
  static LaneVector contact_points(const State& s, const DualSample& sample, const NormBodyPair::Step& step) {
    return s.pair.joined(NormBodyPair::moved_points(sample, step), sample);
  }

  template <class SampleOrEvaluation>
  bool clears(const State& s, const SampleOrEvaluation& e, const Eigen::Vector3d& n, double horizon) const {
    const double least_g = e.g - s.rounding.gap;
    return least_g > 0 && least_g + horizon * (n.dot(v_) - surface_speed() - s.rounding.rate) > 0;
  }

  static ContactPoints contact_points(const State& s, const Eigen::Vector3d& n) {
    const DualSample sample = s.pair.sample(n);
    const LaneVector points = contact_points(s, sample, s.pair.newton_step(sample));
    return {points.a(), points.b()};
  }

  /// Newton's method of n, with retractions on flat faces; where that finds no way up, by contact elements.
  template <class Done>
  geom::kernel::Ascent ascend(const State& s, const Done& done, int& budget, Eigen::Vector3d& n, Evaluation& e) const;

  /// Returns whether n is right. On a face the quadratic model holds for no step at all: nothing may be left to gain.
  bool settled(const Evaluation& e) const { return e.step2 <= settled_step2_ && e.decrement <= kTouching * size(); }

  double certified_step(const State& s, const Evaluation& e, const Eigen::Vector3d& n, double g, double gp,
                        double horizon) const;
  double least_step(const State& s, const Evaluation& e, const Eigen::Vector3d& n, bool touching, double tau) const;
  bool worth_refining(double /*gp*/, double spread) const { return spread <= kTangentAgreement * size() / speed(); }
  /// Backwards in time from a contact the same certificate holds: g >= -rate sigma - K sigma^2/2.
  bool falls_since(const State& s, const Evaluation& e, const Eigen::Vector3d& n, double rate, double span) const;

  Eigen::Vector3d cold_normal(const State& s) const { return s.pair.cold_normal(); }
  /// Searches for a separating normal by every method of geom::distance.
  Separation separating_normal(const State& s, Eigen::Vector3d& n) const;

  Window window(double t_begin, double t_end) const { return sphere_window(r_now_, v_, size(), now_, t_begin, t_end); }
  double size() const { return A_.bounding_radius + B_.bounding_radius; }
  /// Returns a negative number: a stationary point of an overlap is no proof at any depth, faces and edges have many.
  double certified_depth() const { return -1; }
  double speed() const {
    return v_.norm() + A_.bounding_radius * a_.top.max_omega() + B_.bounding_radius * b_.top.max_omega();
  }

 protected:
  double curvature_share_ = 1;  ///< tests take less, to see that contacts are missed then

 private:
  /// g' and K over [0, tau] of one choice of Omega and c.
  struct Certificate {
    const SupportGap& gap;
    double rate;                  ///< g'
    double angular_speed;         ///< |Omega|
    double angular_speed_across;  ///< |Omega x n|
    double distance;              ///< |r|
    double speed;                 ///< |v|
    double bend;                  ///< -f'' - ..., what does not depend on tau
    Lanes slip;                   ///< |Delta|
    Lanes reach;                  ///< |s|
    Lanes height;
    Lanes d1, d2;  ///< |D mu1|, |D mu2| / 2
    Lanes d_max;
    double direction;    ///< error of a direction, as in GeneralRounding
    double hidden_rate;  ///< bound of what rounding hides of g'

    double curvature(double tau) const;  ///< includes what rounding may hide
  };

  Evaluation evaluation(const State& s, const DualSample& sample) const;
  double point_rate(const State& s, const LaneVector& points, const Eigen::Vector3d& n) const {
    return geom::kernel::sum(s.omega.cross(points).dot(LaneVector::of(n, -n)));
  }
  /// A bound of the rate at which turning moves the surfaces along any n.
  double surface_speed() const { return A_.lever * a_.top.max_omega() + B_.lever * b_.top.max_omega(); }
  Certificate certificate(const State& s, const DualSample& at, const NormBodies::Majorant& majorant,
                          const Eigen::Vector3d& Omega) const;
  double longest_step(const State& s, const DualSample& at, const NormBodies::Majorant& majorant, double g,
                      const Eigen::Vector3d& Omega, double horizon, double best) const;
  Eigen::Vector3d angular_velocity_of_best_normal(const State& s, const DualSample& at) const;
  bool tilted_end_clears(const State& s, const Eigen::Vector3d& n, const Eigen::Vector3d& Omega, double least,
                         double tau) const;

  GeneralScales scales_;
  double settled_step2_;  ///< |delta|^2 of a normal that is right
};

template <class Done>
geom::kernel::Ascent SupportGap::ascend(const State& s, const Done& done, int& budget, Eigen::Vector3d& n,
                                        Evaluation& e) const {
  using geom::kernel::Ascent;
  constexpr int kPatience = 20;  // where edges nearly touch, steps may go on with hardly any gain
  constexpr int kElementSteps = 30;
  bool by_elements = false;
  for (int step = 0; !done(e); ++step) {
    if (budget-- <= 0) return Ascent::exhausted;
    DualSample next = e.sample;
    const bool moved = step != kPatience && s.pair.advance(next, e.newton);
    if (!moved) {
      if (by_elements) return Ascent::stalled;
      by_elements = true;
      int iterations = 0;
      const NormBodyPair::Answer answer = s.pair.by_elements(e.sample.n, NormBodyPair::FirstElements::supports,
                                                             NormBodyPair::Pace::careful, kElementSteps, iterations);
      budget -= iterations;
      if (answer.at.g > e.g) {
        next = s.pair.sample(answer.at.n);
      } else if (step != kPatience) {
        return Ascent::stalled;
      }
    }
    n = next.n;
    e = evaluation(s, next);
  }
  return Ascent::converged;
}

}  // namespace ed::internal
