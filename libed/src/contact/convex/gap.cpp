#include "contact/convex/gap.h"

#include "contact/body_shapes.h"
#include "contact/least_step.h"

#include <geom/pose.h>
#include <geom/tolerances.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

constexpr double kNoBound = std::numeric_limits<double>::infinity();
constexpr double kEqual = 1e-14;  // bounds of the gap, or points and the gap, differ by rounding, in units of the size

}  // namespace

ConvexGap::ConvexGap(const ConvexBody& A, const RigidMotion& a, const ConvexBody& B, const RigidMotion& b,
                     const Vector3d& r_now, double now)
    : PairGapBase(A, a, B, b, r_now, now),
      balls_(A.ball + B.ball),
      surface_speed_(A.lever * a.top.max_omega() + B.lever * b.top.max_omega()),
      speed_(v_.norm() + A.bounding_radius * a.top.max_omega() + B.bounding_radius * b.top.max_omega()),
      scales_(GeneralScales::of(A.bounding_radius, a, B.bounding_radius, b, now)) {}

ConvexGap::State ConvexGap::at(double t) const {
  return {t, a_.top.at(t - a_.time), b_.top.at(t - b_.time), r_at(t), scales_.rounding(t)};
}

ConvexGap::Sample ConvexGap::sample(const State& s, const Vector3d& n) const {
  const geom::Support a = A_.core_support(s.a.R, n);
  const geom::Support b = B_.core_support(s.b.R, -n);
  return {(n.dot(s.r) - (a.height + b.height)) - balls_, a.point, b.point};
}

ConvexGap::Evaluation ConvexGap::complete(const State& /*s*/, const Sample& sample, const Vector3d& /*n*/) const {
  Evaluation e;
  e.g = sample.g;
  e.decrement = kNoBound;
  e.step2 = kNoBound;
  e.step.setZero();
  e.point_a = sample.point_a;
  e.point_b = sample.point_b;
  return e;
}

bool ConvexGap::clears(const State& s, const Sample& e, const Vector3d& n, double horizon) const {
  const double least_g = e.g - s.rounding.gap;
  if (!(least_g > 0)) return false;
  if (least_g + horizon * (n.dot(v_) - surface_speed_ - s.rounding.rate) > 0) return true;
  if (!(horizon <= size() / speed_)) return false;
  const Turn fixed = turn(s, n, Vector3d::Zero(), 1);
  return fixed.end(horizon) - s.rounding.gap > 0.5 * horizon * horizon * larger(0.0, fixed.curvature(horizon));
}

/// Takes n and e of the closest features; returns false if there are none.
bool ConvexGap::take_features(const State& /*s*/, const ClosestFeatures& closest, Vector3d& n, Evaluation& e) const {
  if (closest.end == ClosestFeatures::End::inside || closest.features.count == 0) return false;
  if (!(closest.lower > -kNoBound)) return false;  // of a support function that is not a number
  const bool closed = closest.end == ClosestFeatures::End::closed;
  n = closest.n;
  e.g = closest.lower - balls_;
  e.decrement = closed ? 0 : closest.upper - closest.lower;
  e.step2 = closed ? 0 : kNoBound;
  e.step.setZero();
  e.features = closest.features;
  e.point_a = e.features.point_a();
  e.point_b = e.features.point_b();
  return true;
}

/// Takes n and e of a distance; returns false if it is none.
bool ConvexGap::take(const State& s, const geom::DistanceResult& d, Vector3d& n, Evaluation& e) const {
  if (!is_answer(d)) return false;
  n = d.normal;
  e.g = sample(s, n).g;
  // The distance is between g and g + error_bound: bodies that may only touch do not overlap. If the points belong to
  // the normal, the bound only says that another normal may have a larger gap; Newton's method is led by this one.
  const double rounding = std::max(d.residual, kEqual * size());
  const double hidden = d.residual <= kOverlap * size() ? std::min(d.error_bound, rounding) : d.error_bound;
  if (e.g < 0) e.g = std::min(0.0, e.g + hidden);
  e.decrement = 0;
  e.step2 = 0;
  e.step.setZero();
  e.point_a = d.point_a - A_.ball * n;
  e.point_b = (d.point_b - s.r) + B_.ball * n;
  e.features.count = 1;
  e.features.weight[0] = 1;
  e.features.a[0] = e.point_a;
  e.features.b[0] = e.point_b;
  return true;
}

geom::DistanceResult ConvexGap::ask(const State& s, const geom::DistanceOptions& options) const {
  return distance(A_.shape, geom::kernel::unchecked_pose(s.a.R, Vector3d::Zero()), B_.shape,
                  geom::kernel::unchecked_pose(s.b.R, s.r), options);
}

/// Finds n and e of cores that touch, from a normal that is nearly right, where rounding hides the direction of their
/// closest points: moved apart along it by about their size they have the same closest features. False if the bounds
/// of the gap are not made equal by that.
bool ConvexGap::solve_by_features(const State& s, Vector3d& n, Evaluation& e) const {
  if (A_.own_distance || B_.own_distance) return false;
  const PlacedPair pair = placed(s, s.r);
  if (!pair.finite() && !pair.may_close()) return false;
  if (A_.may_be_sharp() || B_.may_be_sharp()) return solve_by_moves(s, n, e);
  Vector3d normal = n;
  for (int move = 0; move < 3; ++move) {
    const double lower = sample(s, normal).g + balls_;
    const Vector3d way = (0.5 * size() - lower) * normal;
    const ClosestFeatures far = descend(s, s.r + way, normal, [](double, double) { return false; });
    if (far.end != ClosestFeatures::End::closed) return false;
    normal = far.n;
    const double gap = sample(s, normal).g + balls_;
    if (!(gap >= -kOverlap * size())) return false;
    const Vector3d between = s.r + far.features.point_b() - far.features.point_a();
    if ((between - gap * normal).norm() > kEqual * size()) continue;
    return take_moved(s, far, normal, gap, n, e);
  }
  return false;
}

/// Finds n and e as solve_by_features does, of cores of which nothing but the support function is known, overlapping
/// ones too (the proximal point method for the largest gap). Goes on while points and normal fit each other better.
///
/// Bounds that agree to rounding leave an error of its square root in the points, the less the nearer the bodies are,
/// and in the normal, the less the further apart they are.
bool ConvexGap::solve_by_moves(const State& s, Vector3d& n, Evaluation& e) const {
  constexpr int kMostMoves = 10;
  constexpr int kMostSteps = 64;
  constexpr double kAgree = 1e-14;  // bounds, in units of the size
  constexpr double kNearer = 1e-2;
  constexpr double kSlow = 0.1;
  Vector3d normal = n;
  double lower = sample(s, normal).g + balls_;
  double distance = 0.5 * size();
  double last = kNoBound;
  struct {
    ClosestFeatures features;
    Vector3d normal;
    double gap = 0;
    double mismatch = kNoBound;
  } best;
  for (int move = 0; move < kMostMoves && !(best.mismatch <= kEqual * size()); ++move) {
    const Vector3d moved = s.r + (distance - lower) * normal;
    const ClosestFeatures far = closest_features(
        placed(s, moved), normal, [](double, double) { return false; }, kMostSteps);
    if (far.end == ClosestFeatures::End::inside || !(far.upper - far.lower <= kAgree * size())) break;
    const double gap = sample(s, far.n).g + balls_;
    if (gap >= lower - kEqual * size()) {
      normal = far.n;
      lower = gap;
    }
    const Vector3d between = s.r + far.features.point_b() - far.features.point_a();
    const double mismatch = (between - lower * normal).norm();
    if (mismatch < best.mismatch) {
      best = {far, normal, lower, mismatch};
    } else if (best.mismatch <= geom::kWidestGap * size()) {
      break;
    }
    if (!(mismatch < kSlow * last)) distance *= kNearer;
    last = mismatch;
  }
  return best.mismatch <= geom::kWidestGap * size() && take_moved(s, best.features, best.normal, best.gap, n, e);
}

/// Takes n and e of features that bodies have that were moved apart.
bool ConvexGap::take_moved(const State& s, const ClosestFeatures& far, const Vector3d& normal, double gap, Vector3d& n,
                           Evaluation& e) const {
  ClosestFeatures near = far;
  near.end = ClosestFeatures::End::closed;
  near.n = normal;
  near.lower = gap;
  near.upper = gap;
  return take_features(s, near, n, e);
}

/// Finds n and e of the distance itself, from n on; false if the query declines.
bool ConvexGap::solve(const State& s, Vector3d& n, Evaluation& e) const {
  if (solve_by_features(s, n, e)) return true;
  const geom::DistanceResult d = ask(s, {.start = n, .penetration = geom::Penetration::local});
  return d.error_bound <= geom::kWidestGap * size() && take(s, d, n, e);
}

geom::DistanceResult ConvexGap::last_resort(const State& s) const {
  return ask(s, {.start = cold_normal(s)});
}

ContactPoints ConvexGap::contact_points(const State& s, const Vector3d& n) const {
  Vector3d normal = n;
  Evaluation e = evaluate(s, n);
  int budget = geom::kMaxIterations;
  const auto done = [&](const Evaluation& trial) { return settled(trial); };
  // The search has had its answer by one of the two.
  if (ascend(s, done, budget, normal, e) != geom::kernel::Ascent::converged) take(s, last_resort(s), normal, e);
  return {e.point_a + A_.ball * normal, e.point_b - B_.ball * normal};
}

ConvexGap::Turn ConvexGap::turn(const State& s, const Vector3d& n, const Vector3d& across, double direction) const {
  // Backwards in time all velocities change their signs, and accelerations do not.
  const Vector3d omega_a = direction * s.a.omega;
  const Vector3d omega_b = direction * s.b.omega;
  const Vector3d W = direction * across;
  // Of Omega = W + spin n, mu2's part across n is spin W - w (2 W - omega_t) - alpha x n, w = omega.n and omega_t the
  // part of omega across n.
  const auto wanted = [&](const Vector3d& omega, const Vector3d& alpha) {
    const double w = omega.dot(n);
    return Vector3d(w * (2 * W - (omega - w * n)) + alpha.cross(n));
  };
  const Vector3d wanted_a = wanted(omega_a, s.a.alpha);
  const Vector3d wanted_b = wanted(omega_b, s.b.alpha);
  const double weight = (A_.core_reach + B_.core_reach) * W.squaredNorm();
  const double spin = weight > 0 ? W.dot(A_.core_reach * wanted_a + B_.core_reach * wanted_b) / weight : 0.0;
  const Vector3d Omega = W + spin * n;
  const Vector3d v = direction * v_;
  const Vector3d turned = Omega.cross(n);
  const auto body = [&](const ConvexBody& shape, const FreeTop& top, const TopState& at, const Vector3d& omega,
                        const Vector3d& lateral, double side) {
    const Vector3d slip = Omega - omega;
    const Vector3d mu = slip.cross(side * n);
    const double mu2 = mu.squaredNorm();
    const Vector3d bent = spin * W - lateral;
    const double bend = shape.line() ? std::abs((bent - mu2 * n).dot(at.R.col(2))) : bent.norm();
    return Turn::Body{shape, top, mu, std::sqrt(mu2), slip.norm(), bend};
  };
  return {.gap = *this,
          .s = s,
          .n = n,
          .v = v,
          .turned = turned,
          .angular_speed = Omega.norm(),
          .distance = s.r.norm(),
          .bend = -Omega.cross(turned).dot(s.r) - 2 * turned.dot(v),
          .centre_rate = turned.dot(s.r) + n.dot(v),
          .a = body(A_, a_.top, s.a, omega_a, wanted_a, 1),
          .b = body(B_, b_.top, s.b, omega_b, wanted_b, -1)};
}

double ConvexGap::Turn::body_curvature(const Body& body, double tau) const {
  const double both = angular_speed + body.top.max_omega();
  const double alpha = body.top.max_alpha();
  const double slip = smaller(body.slip + alpha * tau, both);
  const double crude = body.shape.core_reach * (slip * both + alpha);
  const double mu2 = body.mu_length * body.mu_length;
  const double reach = body.shape.core_reach;
  if (!body.shape.line() && !(mu2 * tau * tau <= 2)) return crude;
  const double M3 = slip * both * both + 3 * alpha * both + body.top.max_jerk();
  if (body.shape.line()) return smaller(crude, reach * (body.lateral + M3 / 3 * tau));
  return smaller(crude, reach * (body.lateral + (mu2 * body.mu_length + M3 / 3) * tau) - body.shape.core_inner * mu2);
}

double ConvexGap::Turn::curvature(double tau) const {
  const double speed = v.norm();
  const double crude = angular_speed * (angular_speed * (distance + speed * tau) + 2 * speed);
  const double third = angular_speed * turned.norm() * (angular_speed * (distance + speed * tau) + 3 * speed);
  const double centres = smaller(crude, bend + third * tau / 3);
  const auto unresolved = [&](const Body& body) {
    const double both = angular_speed + body.top.max_omega();
    return body.shape.core_reach * (both * both + body.top.max_alpha());
  };
  const double hidden = s.rounding.direction * (unresolved(a) + unresolved(b) + crude);
  return gap.curvature_share_ * (body_curvature(a, tau) + body_curvature(b, tau) + centres) + hidden;
}

/// Directions at the end are known to `direction` of their length and of their changes, and heights along them as well
/// as along unit vectors, relative to their length.
double ConvexGap::Turn::hidden(double tau) const {
  const double rates = 2 * angular_speed + a.top.max_omega() + b.top.max_omega();
  const double moved = angular_speed * distance + v.norm() + gap.scales_.surface_speed + angular_speed * gap.size();
  return gap.scales_.later(tau) + tau * (rates * s.rounding.gap + s.rounding.direction * moved);
}

double ConvexGap::Turn::end(double tau) const {
  const double height_a = a.shape.core_support(s.a.R, n + tau * a.mu).height;
  const double height_b = b.shape.core_support(s.b.R, tau * b.mu - n).height;
  return (n.dot(s.r) + tau * centre_rate - (height_a + height_b)) - gap.balls_ - hidden(tau);
}

/// Returns the longest step of one choice for a gap that is certainly g and changes at about the rate gp.
///
/// Tilted ends too far away tell little. What the chord to one sags below the tangent, and K, tell how far away a
/// better one is.
double ConvexGap::longest_step(const Turn& turn, double g, double gp, double horizon) const {
  constexpr int kTrials = 5;
  const double gap = turn.s.rounding.gap;
  double tau = 0;
  double reach = smaller(horizon, size() / speed_);
  for (int trial = 0; trial < kTrials; ++trial) {
    const double slope = (turn.end(reach) - gap - g) / reach;
    const double K = turn.curvature(reach);
    tau = larger(tau, smaller(reach, first_root(g, slope, K)));
    if (tau >= reach) break;
    const double likely = first_root(g, gp, larger(0.0, K + 2 * (gp - slope) / reach));
    const double next = smaller(0.7 * reach, 1.3 * likely);
    if (!(next > tau)) break;
    reach = next;
  }
  return tau;
}

Vector3d ConvexGap::turning_of_best_normal(const State& s, const Evaluation& e, const Vector3d& n) const {
  if (A_.rims() || B_.rims()) {
    return turning_with_rims(placed(s, s.r), e.features, n, e.g + balls_, {v_, s.a.omega, s.b.omega});
  }
  return turning_of_normal(e.features, n, e.g + balls_, v_, s.a.omega, s.b.omega);
}

double ConvexGap::certified_step(const State& s, const Evaluation& e, const Vector3d& n, double computed_g, double gp,
                                 double horizon) const {
  const double g = larger(0.0, computed_g - s.rounding.gap);
  double tau = smaller(horizon, g / speed_);  // nothing moves faster
  for (const Vector3d& across : {turning_of_best_normal(s, e, n), Vector3d(Vector3d::Zero())}) {
    if (tau >= horizon) break;
    tau = larger(tau, longest_step(turn(s, n, across, 1), g, gp, horizon));
  }
  return tau;
}

double ConvexGap::least_step(const State& s, const Evaluation& e, const Vector3d& n, bool touching, double tau) const {
  const double unit = size() / speed_;
  if (tau > kShortStep * unit) return tau;
  const auto across = [&](const Vector3d& omega) { return Vector3d(omega - omega.dot(n) * n); };
  const std::array<Turn, 4> turns{turn(s, n, Vector3d::Zero(), 1), turn(s, n, turning_of_best_normal(s, e, n), 1),
                                  turn(s, n, across(s.a.omega), 1), turn(s, n, across(s.b.omega), 1)};
  return longest_clear_step(touching ? kTouching * unit : tau, unit, [&](double trial) {
    return std::any_of(turns.begin(), turns.end(), [&](const Turn& choice) {
      // g of bodies that touch is not known: it may fall by what rounding hides.
      const double least = touching ? -choice.hidden(trial) : s.rounding.gap;
      return choice.end(trial) - least > 0.5 * trial * trial * larger(0.0, choice.curvature(trial));
    });
  });
}

// The same certificate holds backwards in time from a contact, with g = 0 there. Its rate does not show over times as
// short as the span may be: longer ones include it.
bool ConvexGap::falls_since(const State& s, const Evaluation& e, const Vector3d& n, double rate, double span) const {
  if (!(rate < -kResting * speed_)) return false;
  if (!(span > 0)) return true;
  const auto across = [&](const Vector3d& omega) { return Vector3d(omega - omega.dot(n) * n); };
  const std::array<Turn, 4> turns{turn(s, n, turning_of_best_normal(s, e, n), -1), turn(s, n, Vector3d::Zero(), -1),
                                  turn(s, n, across(s.a.omega), -1), turn(s, n, across(s.b.omega), -1)};
  const double unit = size() / speed_;
  for (const double longer : {0.0, 1e-9, 1e-6, 1e-4}) {
    const double reach = larger(span, longer * unit);
    for (const Turn& choice : turns) {
      if (choice.end(reach) - s.rounding.gap > 0.5 * reach * reach * larger(0.0, choice.curvature(reach))) return true;
    }
  }
  return false;
}

Vector3d ConvexGap::cold_normal(const State& s) const {
  return s.r.squaredNorm() > 0 ? Vector3d(s.r.stableNormalized()) : Vector3d::UnitX();
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
