#include "contact/convex_gap.h"

#include "contact/body_shapes.h"
#include "contact/least_step.h"

#include <geom/pose.h>
#include <geom/tolerances.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

/// A step is shortened this often, by this factor, until its chord certifies it.
constexpr int kTrials = 30;
constexpr double kShorter = 0.5;

/// Newton's method of the normal takes no more from a warm start; where it does, at a kink of the support function, it
/// does not converge at all, and the closest points are found otherwise.
constexpr int kNewtonSteps = 10;

double curvature_radius(const BodyShape& shape) {
  const auto of = [](const auto& s) -> double {
    if constexpr (requires { s.min_curvature_radius(); }) return s.min_curvature_radius();
    return 0;
  };
  return std::visit(of, shape);
}

/// Returns the support point along n in the world's axes.
geom::Support world_support(const BodyShape& shape, const geom::Pose& pose, const Vector3d& n) {
  const geom::Support s = support(shape, transposed_product(pose.rotation(), n));
  return {s.height, pose.rotation() * s.point};
}

/// Returns the least of (1 - x) g0 + x g1 - K T^2 x (1 - x) / 2 over x in [0, 1].
double lowest(double g0, double g1, double KT2) {
  const double slope = g1 - g0 - 0.5 * KT2;
  if (slope >= 0) return g0;
  if (slope <= -KT2) return g1;
  return g0 - 0.5 * slope * slope / KT2;
}

}  // namespace

ConvexGap::ConvexGap(const BodyShape& A, const RigidMotion& a, const BodyShape& B, const RigidMotion& b,
                     const Vector3d& r_now, double now)
    : A_(A),
      B_(B),
      a_(a),
      b_(b),
      r_now_(r_now),
      v_(b.velocity - a.velocity),
      now_(now),
      reach_a_(bounding_radius(A)),
      reach_b_(bounding_radius(B)),
      depth_(curvature_radius(A) + curvature_radius(B)),
      surface_speed_(turning_lever(A) * a.top.max_omega() + turning_lever(B) * b.top.max_omega()),
      speed_(v_.norm() + reach_a_ * a.top.max_omega() + reach_b_ * b.top.max_omega()),
      scales_(GeneralScales::of(reach_a_, a, reach_b_, b, now)) {}

ConvexGap::State ConvexGap::at(double t) const {
  const TopState a = a_.top.at(t - a_.time);
  const TopState b = b_.top.at(t - b_.time);
  return {t,
          geom::kernel::unchecked_pose(a.R, Vector3d::Zero()),
          geom::kernel::unchecked_pose(b.R, r_now_ + (t - now_) * v_),
          a.omega,
          b.omega,
          scales_.rounding(t)};
}

ConvexGap::Sample ConvexGap::sample(const State& s, const Vector3d& n) const {
  const geom::Support a = world_support(A_, s.a, n);
  const geom::Support b = world_support(B_, s.b, -n);
  return {n.dot(s.b.position()) - (a.height + b.height), a.point, b.point};
}

ConvexGap::Evaluation ConvexGap::complete(const State& /*s*/, const Sample& sample, const Vector3d& /*n*/) const {
  Evaluation e;
  e.g = sample.g;
  e.decrement = std::numeric_limits<double>::infinity();
  e.step2 = std::numeric_limits<double>::infinity();
  e.step.setZero();
  e.point_a = sample.point_a;
  e.point_b = sample.point_b;
  return e;
}

/// n and e of an answer; false if it is none.
bool ConvexGap::take(const State& s, const geom::DistanceResult& d, Vector3d& n, Evaluation& e) const {
  if (!is_answer(d)) return false;
  n = d.normal;
  e.g = sample(s, n).g;
  // The distance is between g and g + error_bound: bodies that may only touch do not overlap.
  if (e.g < 0) e.g = std::min(0.0, e.g + d.error_bound);
  e.decrement = 0;
  e.step2 = 0;
  e.step.setZero();
  e.point_a = d.point_a;
  e.point_b = d.point_b - s.b.position();
  return true;
}

/// n and e of the distance itself, from n on; false if the query declines.
bool ConvexGap::solve(const State& s, Vector3d& n, Evaluation& e) const {
  return take(
      s,
      distance(A_, s.a, B_, s.b, {.start = n, .max_iterations = kNewtonSteps, .penetration = geom::Penetration::local}),
      n, e);
}

geom::DistanceResult ConvexGap::last_resort(const State& s) const {
  return distance(A_, s.a, B_, s.b, {.start = cold_normal(s)});
}

ContactPoints ConvexGap::contact_points(const State& s, const Vector3d& n) const {
  Vector3d normal = n;
  Evaluation e = evaluate(s, n);
  // The search has had its answer by one of the two.
  if (!solve(s, normal, e)) take(s, last_resort(s), normal, e);
  return {e.point_a, e.point_b};
}

double ConvexGap::chord_curvature(double T, const Vector3d& n0, const Vector3d& n1, double distance) const {
  const double chord = 0.5 * (n1 - n0).norm();
  const double angular_speed = 2 * std::asin(std::min(1.0, chord)) / T;
  const auto bend = [angular_speed](const FreeTop& top) {
    const double w = angular_speed + top.max_omega();
    return w * w + top.max_alpha();
  };
  const double centres = angular_speed * (angular_speed * (distance + v_.norm() * T) + 2 * v_.norm());
  return kBoundMargin * (reach_a_ * bend(a_.top) + reach_b_ * bend(b_.top) + centres);
}

/// Returns whether no contact comes up to s.t + T, for a gap that is certainly g >= 0 along n now; `end`: the distance
/// there. What rounding may hide is subtracted, except for bodies that are taken to touch.
bool ConvexGap::chord_clears(const State& s, const Vector3d& n, double g, bool touching, double T, double& end) const {
  const State later = at(s.t + T);
  const double hidden = touching ? 0 : s.rounding.gap + scales_.later(T);
  Vector3d n1 = n;
  Evaluation e = evaluate(later, n);
  const double fixed = e.g - hidden;
  const bool solved = solve(later, n1, e);
  end = e.g - hidden;
  // Tries another normal at the end first, then the same one.
  for (const bool moving : {true, false}) {
    if (moving && !solved) continue;
    const double g1 = moving ? end : fixed;
    if (!(g1 >= 0)) continue;
    const double K = chord_curvature(T, n, moving ? n1 : n, s.b.position().norm());
    if (lowest(g, g1, K * T * T) >= 0) return true;
  }
  return false;
}

double ConvexGap::certified_step(const State& s, const Evaluation& /*e*/, const Vector3d& n, double computed_g,
                                 double gp, double horizon) const {
  const double g = std::max(0.0, computed_g - s.rounding.gap);
  // The first trial goes to the end of the tangent or, for bodies that part or hardly approach, as far as the sag of a
  // chord allows.
  const double K = chord_curvature(1, n, n, 0);
  double T = std::min(horizon, std::max(gp < 0 ? -g / gp : 0.0, std::sqrt(2 * g / K)));
  for (int trial = 0; trial < kTrials && T * speed_ > g; ++trial) {
    double end = 0;
    if (chord_clears(s, n, g, false, T, end)) return T;
    // The secant's root if the bodies overlap there, a little short of it.
    const double share = end < 0 ? 0.999 * g / (g - end) : kShorter;
    T *= std::min(share, trial % 2 == 0 ? 0.9999 : kShorter);
  }
  return std::min(horizon, g / speed_);  // nothing moves faster
}

double ConvexGap::least_step(const State& s, const Evaluation& /*e*/, const Vector3d& n, bool touching,
                             double tau) const {
  const double unit = size() / speed_;
  if (!touching || tau > kShortStep * unit) return tau;
  // g of bodies that touch is not known: it may fall by what rounding hides.
  double end = 0;
  return longest_clear_step(kTouching * unit, unit,
                            [&](double trial) { return chord_clears(s, n, 0, true, trial, end); });
}

bool ConvexGap::falls_since(const State& s, const Evaluation& /*e*/, const Vector3d& n, double rate,
                            double span) const {
  if (!(rate < -kResting * speed_)) return false;
  if (!(span > 0)) return true;
  const State before = at(s.t - span);
  Vector3d n0 = n;
  Evaluation e = evaluate(before, n);
  if (!solve(before, n0, e)) return false;
  return e.g >= before.rounding.gap + 0.5 * chord_curvature(span, n0, n, before.b.position().norm()) * span * span;
}

Vector3d ConvexGap::cold_normal(const State& s) const {
  const Vector3d& r = s.b.position();
  return r.squaredNorm() > 0 ? Vector3d(r.stableNormalized()) : Vector3d::UnitX();
}

Separation ConvexGap::separating_normal(const State& s, Vector3d& n) const {
  const geom::DistanceResult d = last_resort(s);
  if (!is_answer(d)) return Separation::declined;
  n = d.normal;
  const double g = sample(s, n).g;
  if (g + d.error_bound < -kOverlap * size()) return Separation::overlapping;
  return g >= -kOverlap * size() || d.error_bound <= geom::kWidestGap * size() ? Separation::apart
                                                                               : Separation::declined;
}

}  // namespace ed::internal
