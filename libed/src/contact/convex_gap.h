#pragma once

/// The pair gap of two convex bodies of which nothing is known but their support functions and radii: a user's own
/// shapes (uniaxial_gap.h defines pair gaps), and the steps it certifies. Every evaluation is a whole distance
/// query.
///
/// Chords. Let the normal turn uniformly from n0 now to n1 at T, by an angle a, so that Omega = a / T. Seen from a body
/// that turns at omega(t), |omega| <= w, |d omega/dt| <= w', its direction u(tau) has |u''| <= B = (Omega + w)^2 + w'.
/// Between two of its values it is within B tau (T - tau) / 2 of the straight line, a support function is convex and
/// changes by at most the bounding radius R times the change of its argument: so
///
///     h(tau) <= (1 - tau/T) h(0) + (tau/T) h(T) + R B tau (T - tau) / 2.
///
/// For the centres' part f = n.(r + v tau), |f''| <= Omega^2 max |r + v tau| + 2 Omega |v|. With the gaps g0 and g1
/// along n0 and n1 at both ends, all tau in [0, T] and K the sum of both bodies' R B and of that,
///
///     distance(tau) >= g(tau) >= (1 - tau/T) g0 + (tau/T) g1 - K tau (T - tau) / 2,
///
/// which is positive between the ends if it falls all the way (g0 - g1 >= K T^2 / 2), or its lowest value is. The ends
/// may be the distances themselves, so that the step up to a contact is certified by Newton's method of d(t), however
/// edged or flat the bodies are: the curvature of their surfaces does not enter.

#include "contact/curvature_steps.h"
#include "contact/rounding.h"
#include "contact/separation.h"
#include "contact/sphere_window.h"
#include "motion/rigid_motion.h"

#include <ed/shape.h>
#include <ed/tolerances.h>

#include <geom/distance.h>
#include <geom/kernel/dual_newton.h>

#include <Eigen/Core>

namespace ed::internal {

class ConvexGap {
 public:
  struct State {
    double t;
    geom::Pose a, b;  ///< poses relative to A's centre
    Eigen::Vector3d omega_a, omega_b;
    GeneralRounding rounding;
  };
  struct Sample {
    double g;
    Eigen::Vector3d point_a, point_b;  ///< support points, from the bodies' centres
  };
  struct Evaluation : geom::kernel::Evaluation {
    Eigen::Vector3d point_a, point_b;  ///< closest points, or support points, from the bodies' centres
  };

  /// `r_now`: the vector from A's centre to B's at `now`, in the image that is meant.
  ConvexGap(const BodyShape& A, const RigidMotion& a, const BodyShape& B, const RigidMotion& b,
            const Eigen::Vector3d& r_now, double now);

  State at(double t) const;
  Sample sample(const State& s, const Eigen::Vector3d& n) const;
  /// No Newton step: `ascend` asks for the distance.
  Evaluation complete(const State& s, const Sample& sample, const Eigen::Vector3d& n) const;
  Evaluation evaluate(const State& s, const Eigen::Vector3d& n) const { return complete(s, sample(s, n), n); }

  /// dd/dt: the closest points move with their bodies.
  double rate(const State& s, const Evaluation& e, const Eigen::Vector3d& n) const {
    return n.dot(v_ + s.omega_b.cross(e.point_b) - s.omega_a.cross(e.point_a));
  }
  double contact_rate(const State& s, const Evaluation& e, const Eigen::Vector3d& n) const { return rate(s, e, n); }

  template <class SampleOrEvaluation>
  bool clears(const State& s, const SampleOrEvaluation& e, const Eigen::Vector3d& n, double horizon) const {
    const double least_g = e.g - s.rounding.gap;
    return least_g > 0 && least_g + horizon * (n.dot(v_) - surface_speed_ - s.rounding.rate) > 0;
  }
  template <class Done>
  geom::kernel::Ascent ascend(const State& s, const Done& done, int& budget, Eigen::Vector3d& n, Evaluation& e) const {
    if (done(e)) return geom::kernel::Ascent::converged;
    --budget;
    return solve(s, n, e) ? geom::kernel::Ascent::converged : geom::kernel::Ascent::stalled;
  }

  bool settled(const Evaluation& e) const { return e.step2 == 0; }

  double certified_step(const State& s, const Evaluation& e, const Eigen::Vector3d& n, double g, double gp,
                        double horizon) const;
  double least_step(const State& s, const Evaluation& e, const Eigen::Vector3d& n, bool touching, double tau) const;
  bool worth_refining(double /*gp*/, double spread) const { return spread <= kTangentAgreement * size() / speed_; }
  bool falls_since(const State& s, const Evaluation& e, const Eigen::Vector3d& n, double rate, double span) const;

  Eigen::Vector3d cold_normal(const State& s) const;
  Separation separating_normal(const State& s, Eigen::Vector3d& n) const;
  Window window(double t_begin, double t_end) const { return sphere_window(r_now_, v_, size(), now_, t_begin, t_end); }
  double size() const { return reach_a_ + reach_b_; }
  double certified_depth() const { return depth_; }
  double speed() const { return speed_; }

  /// The closest points.
  ContactPoints contact_points(const State& s, const Eigen::Vector3d& n) const;

 private:
  /// K of a chord over T along which the normal turns from n0 to n1.
  double chord_curvature(double T, const Eigen::Vector3d& n0, const Eigen::Vector3d& n1, double distance) const;
  bool solve(const State& s, Eigen::Vector3d& n, Evaluation& e) const;
  geom::DistanceResult last_resort(const State& s) const;
  bool take(const State& s, const geom::DistanceResult& d, Eigen::Vector3d& n, Evaluation& e) const;
  bool chord_clears(const State& s, const Eigen::Vector3d& n, double g, bool touching, double T, double& end) const;

  const BodyShape& A_;
  const BodyShape& B_;
  const RigidMotion& a_;
  const RigidMotion& b_;
  Eigen::Vector3d r_now_;
  Eigen::Vector3d v_;
  double now_;
  double reach_a_, reach_b_;  ///< bounding radii
  double depth_;
  double surface_speed_;  ///< the fastest that turning can move the surfaces along a normal
  double speed_;          ///< a bound of |dd/dt|
  GeneralScales scales_;
};

}  // namespace ed::internal
