#pragma once

/// The pair gap of two convex bodies of which nothing is known but their support functions and radii: shapes with edges
/// and faces, and a user's own (uniaxial_gap.h defines pair gaps), and the steps it certifies.
///
/// Tilted ends. Let n turn at a constant Omega from now on, and let a body turn at omega(t). In axes that turn with the
/// body (and agree with the world's now) the direction is u(tau), |u| = 1, with u(0) = n and, Delta = Omega - omega,
///
///     u' = mu = Delta x n,   u'' = mu2 = Delta x (Omega x n) - omega x mu - alpha x n,   |u'''| <= M3,
///
/// M3 as in support_gap.h. |u''| <= X2 = |Delta| (|Omega| + |omega|) + |alpha|, all at their largest in [0, tau]. A
/// support function is convex and changes by no more than the bounding radius R times the change of its argument. With
/// m = n + tau mu, the direction at the end to first order, and theta = tau'/tau, for all tau' <= tau
///
///     h(tau') <= (1 - theta) h(n) + theta h(m) + X2 R tau'^2/2.
///
/// The part of mu2 along n is -|mu|^2 and makes the direction shorter, not longer. Let w = 1 - |mu|^2 tau'^2/2 >= 0:
/// then u = w (n + tau' mu) + (mu2 + |mu|^2 n) tau'^2/2 + rest, |rest| <= (|mu|^3 + M3/3) tau'^3/2, and as h(n + tau'
/// mu) is at least the inscribed radius R0 (its argument is no shorter than 1),
///
///     h(tau') <= (1 - theta) h(n) + theta h(m) + [R |mu2 + |mu|^2 n| + R (|mu|^3 + M3/3) tau - R0 |mu|^2] tau'^2/2.
///
/// The smaller bracket is K of the body. A segment of half-length l along u has h = l |x|, x = m.u, and x'' is mu2.u
/// now: its K is l (|mu2.u| + M3 tau/3). The ball that is swept over a core has the same h for all unit vectors: h, R
/// and R0 are those of the core alone. The centres' part f = n.(r + v tau) has f'' as in support_gap.h. In all, with g1
/// made of f(0) + f'(0) tau and of h(m),
///
///     distance(tau') >= g(tau') >= (1 - theta) g(0) + theta g1 - K tau'^2/2,   K = K_A + K_B + K_centres,
///
/// so that two support evaluations of each body certify a whole step: to the end, if g1 >= K tau^2/2 (the bound is a
/// concave function, or a convex one that falls no lower than its first root), else up to its first root. To second
/// order along smooth surfaces, edges and faces alike, if n turns as the contact does (convex/features.h); Omega = 0 is
/// the other candidate, and the longer step wins. The component of Omega along n is free: it is chosen so that |mu2 +
/// |mu|^2 n| of both bodies is small.
///
/// Newton's method on d(t) ends the search, with the closest points of the closest features. That the contact is the
/// first one is proved by the same bound backwards in time, from g = 0 on.

#include "contact/convex/body.h"
#include "contact/convex/features.h"
#include "contact/curvature_steps.h"
#include "contact/pair_gap_base.h"
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

class ConvexGap : private PairGapBase<ConvexBody, RigidMotion> {
 public:
  struct State {
    double t;
    TopState a, b;
    Eigen::Vector3d r;  ///< vector from A's centre to B's
    GeneralRounding rounding;
  };
  struct Sample {
    double g;
    Eigen::Vector3d point_a, point_b;  ///< support points of the cores, from the bodies' centres
  };
  struct Evaluation : geom::kernel::Evaluation {
    Eigen::Vector3d point_a, point_b;  ///< closest points, or support points, of the cores, from the bodies' centres
    ConvexFeatures features;           ///< closest features, if known
  };

  /// `r_now`: the vector from A's centre to B's at `now`, in the image that is meant.
  ConvexGap(const ConvexBody& A, const RigidMotion& a, const ConvexBody& B, const RigidMotion& b,
            const Eigen::Vector3d& r_now, double now);

  State at(double t) const;
  Sample sample(const State& s, const Eigen::Vector3d& n) const;
  /// Returns what a sample tells, without a Newton step: `ascend` searches for the closest features.
  Evaluation complete(const State& s, const Sample& sample, const Eigen::Vector3d& n) const;
  Evaluation evaluate(const State& s, const Eigen::Vector3d& n) const { return complete(s, sample(s, n), n); }

  /// Returns dd/dt: the closest points move with their bodies.
  double rate(const State& s, const Evaluation& e, const Eigen::Vector3d& n) const {
    return n.dot(v_ + s.b.omega.cross(e.point_b) - s.a.omega.cross(e.point_a));
  }
  double contact_rate(const State& s, const Evaluation& e, const Eigen::Vector3d& n) const { return rate(s, e, n); }

  bool clears(const State& s, const Evaluation& e, const Eigen::Vector3d& n, double horizon) const {
    const double least_g = e.g - s.rounding.gap;
    return least_g > 0 && least_g + horizon * (n.dot(v_) - surface_speed_ - s.rounding.rate) > 0;
  }
  /// Returns whether n certifies the whole horizon: by what is known anyway, or at a tilted end.
  bool clears(const State& s, const Sample& e, const Eigen::Vector3d& n, double horizon) const;

  template <class Done>
  geom::kernel::Ascent ascend(const State& s, const Done& done, int& budget, Eigen::Vector3d& n, Evaluation& e) const;

  bool settled(const Evaluation& e) const { return e.step2 == 0; }

  double certified_step(const State& s, const Evaluation& e, const Eigen::Vector3d& n, double g, double gp,
                        double horizon) const;
  double least_step(const State& s, const Evaluation& e, const Eigen::Vector3d& n, bool touching, double tau) const;
  bool worth_refining(double /*gp*/, double spread) const { return spread <= kTangentAgreement * size() / speed_; }
  bool falls_since(const State& s, const Evaluation& e, const Eigen::Vector3d& n, double rate, double span) const;

  Eigen::Vector3d cold_normal(const State& s) const;
  Separation separating_normal(const State& s, Eigen::Vector3d& n) const;
  Window window(double t_begin, double t_end) const { return sphere_window(r_now_, v_, size(), now_, t_begin, t_end); }
  double size() const { return A_.bounding_radius + B_.bounding_radius; }
  double certified_depth() const { return balls_; }
  double speed() const { return speed_; }

  /// Returns the closest points.
  ContactPoints contact_points(const State& s, const Eigen::Vector3d& n) const;

 protected:
  double curvature_share_ = 1;  ///< tests take less, to see that contacts are missed then

 private:
  /// Choice of Omega, forwards in time or backwards.
  struct Turn {
    const ConvexGap& gap;
    const State& s;
    const Eigen::Vector3d& n;
    Eigen::Vector3d v;       ///< relative velocity
    Eigen::Vector3d turned;  ///< Omega x n
    double angular_speed;    ///< |Omega|
    double distance;         ///< |r|
    double bend;             ///< -f''
    double centre_rate;      ///< f'
    struct Body {
      const ConvexBody& shape;
      const FreeTop& top;
      Eigen::Vector3d mu;
      double mu_length;
      double slip;     ///< |Delta|
      double lateral;  ///< |mu2 + |mu|^2 n|; |mu2.u| of a segment along u
    };
    Body a, b;

    /// Returns K over [0, tau], what rounding may hide included.
    double curvature(double tau) const;
    double body_curvature(const Body& body, double tau) const;
    /// Returns g1 less what rounding may hide beyond s.rounding.gap.
    double end(double tau) const;
    double hidden(double tau) const;
  };

  /// Returns the choice with this part of Omega across n. `direction`: 1 forwards in time, -1 backwards.
  Turn turn(const State& s, const Eigen::Vector3d& n, const Eigen::Vector3d& across, double direction) const;
  double longest_step(const Turn& turn, double g, double gp, double horizon) const;
  Eigen::Vector3d turning_of_best_normal(const State& s, const Evaluation& e, const Eigen::Vector3d& n) const;
  PlacedPair placed(const State& s, const Eigen::Vector3d& r) const { return {A_, B_, s.a.R, s.b.R, r, size()}; }
  template <class Enough>
  ClosestFeatures descend(const State& s, const Eigen::Vector3d& r, const Eigen::Vector3d& n,
                          const Enough& enough) const {
    const PlacedPair pair = placed(s, r);
    if (pair.lines()) {
      ClosestFeatures closest = line_features(pair);
      if (closest.end == ClosestFeatures::End::closed) return closest;
    }
    return closest_features(pair, n, enough);
  }
  bool take_features(const State& s, const ClosestFeatures& features, Eigen::Vector3d& n, Evaluation& e) const;
  bool solve(const State& s, Eigen::Vector3d& n, Evaluation& e) const;
  bool solve_by_features(const State& s, Eigen::Vector3d& n, Evaluation& e) const;
  bool solve_by_moves(const State& s, Eigen::Vector3d& n, Evaluation& e) const;
  bool take_moved(const State& s, const ClosestFeatures& far, const Eigen::Vector3d& normal, double gap,
                  Eigen::Vector3d& n, Evaluation& e) const;
  geom::DistanceResult ask(const State& s, const geom::DistanceOptions& options) const;
  geom::DistanceResult last_resort(const State& s) const;
  bool take(const State& s, const geom::DistanceResult& d, Eigen::Vector3d& n, Evaluation& e) const;

  double balls_;          ///< sum of both balls' radii
  double surface_speed_;  ///< the fastest that turning can move the surfaces along a normal
  double speed_;          ///< a bound of |dd/dt|
  GeneralScales scales_;
};

template <class Done>
geom::kernel::Ascent ConvexGap::ascend(const State& s, const Done& done, int& budget, Eigen::Vector3d& n,
                                       Evaluation& e) const {
  using geom::kernel::Ascent;
  if (e.step2 == 0 && done(e)) return Ascent::converged;
  if (!A_.own_distance && !B_.own_distance) {
    const auto loosely = [&](double lower, double upper) {
      const double g = lower - balls_;
      return g > s.rounding.gap && upper - lower <= kLooseDecrement * g;
    };
    const auto never = [](double, double) { return false; };
    ClosestFeatures closest = descend(s, s.r, n, loosely);
    budget -= closest.evaluations;
    if (take_features(s, closest, n, e) && done(e)) return Ascent::converged;
    if (closest.end == ClosestFeatures::End::enough) {
      closest = descend(s, s.r, n, never);
      budget -= closest.evaluations;
      if (take_features(s, closest, n, e) && done(e)) return Ascent::converged;
    }
  }
  --budget;
  return solve(s, n, e) ? Ascent::converged : Ascent::stalled;
}

}  // namespace ed::internal
