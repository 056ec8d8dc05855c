#include <geom/kernel/norm_body_pair.h>

#include <geom/kernel/dual_newton.h>
#include <geom/tolerances.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace geom::kernel {
namespace {

using Eigen::Vector3d;

// Lengths are in units of the scale, the sum of both bounding radii, unless stated otherwise.

/// Mismatch of the support points that counts as rounding, see kTightGap.
constexpr double kTightResidual = 1e-14;
/// Largest mismatch of the support points that rounding can cause at the stationary normal of an overlap.
constexpr double kSmallResidual = 1e-8;
/// Mismatch of the support points above which an overlap's normal is not a maximum to rounding but stuck beside one.
constexpr double kStuck = 1e-12;
/// Gain of any other normal below which the search from a stuck one ends.
constexpr double kStuckDepthGap = 1e-12;

/// Success of an ascent: g grows by more than kGrowth, or falls by no more while the mismatch of the support points
/// shrinks below kShrink of its previous value.
constexpr double kGrowth = 1e-15;
constexpr double kShrink = 0.9;
/// Newton step of the normal (radian) and its predicted gain: if both are smaller, only rounding remains.
constexpr double kRoundingStep = 1e-9;
constexpr double kRoundingDecrement = 1e-16;
/// Predicted gain that may be invisible in g; the step is accepted if the next predicted gain is less than
/// kPromiseShrink of it.
constexpr double kHiddenDecrement = 1e-14;
constexpr double kPromiseShrink = 0.1;

/// Factor by which steps along a surface are shortened. Dimensionless.
constexpr double kShorterMove = 0.4;

/// The dual method is fast while the mismatch of the support points after a step is at most kFast of the smallest
/// before. It has kTrials steps to become fast, and kPatience to converge.
constexpr double kFast = 0.5;
constexpr int kTrials = 2;
constexpr int kPatience = 9;
/// Maximum number of steps of the other methods, in the order in which they are tried.
constexpr int kElementSteps = 24;
constexpr int kMorePatience = 25;
constexpr int kCarefulSteps = 100;

}  // namespace

DualSample NormBodyPair::sample(const Vector3d& n) const {
  DualSample s;
  s.n = n;
  s.support = bodies_.support(n);
  s.g = r_.dot(n) - s.support.height[0] - s.support.height[1];
  const Vector3d gap = r_ - s.support.point.a() + s.support.point.b();
  s.y = gap - gap.dot(n) * n;
  s.residual = s.y.norm();
  return s;
}

Tangent NormBodyPair::tangent(const Vector3d& n) const {
  const DualSample s = sample(n);
  return {n, r_ - s.support.point.a() + s.support.point.b(), s.g};
}

NormBodyPair::TangentMatrix NormBodyPair::tangent_matrix(const DualSample& s) const {
  const HessianSum S(s.n, s.support.t1, s.support.t2);
  const double smallest = S.smallest();
  const bool lifted = s.g + smallest < floor_;
  return {S, lifted ? floor_ - smallest : s.g, lifted};
}

Vector3d NormBodyPair::tangent_solve(const DualSample& s, const Vector3d& y) const {
  return tangent_matrix(s).solve(y);
}

/// Uses the eigenvalues of S + g I.
Vector3d NormBodyPair::upward(const DualSample& s, double rounding) const {
  const TangentBasis basis(s.n);
  TangentForm form{s.g, 0, s.g};
  for (const LaneVector* t : {&s.support.t1, &s.support.t2}) {
    const Lanes e = t->dot(basis.e);
    const Lanes f = t->dot(basis.f);
    form.ee += sum(e * e);
    form.ef += sum(e * f);
    form.ff += sum(f * f);
  }
  return form.direction_below(-rounding, basis);
}

NormBodyPair::Step NormBodyPair::newton_step(const DualSample& s) const {
  const TangentMatrix M = tangent_matrix(s);
  const Vector3d delta = M.solve(s.y);
  return {delta, delta.dot(s.y), M.lifted};
}

LaneVector NormBodyPair::moved_points(const DualSample& s, const Step& step) {
  // In an overlap a step whose matrix had to be made definite may lead anywhere.
  if (step.lifted && s.g < 0) return s.support.point;
  return s.support.point + moves(s, step);
}

LaneVector NormBodyPair::moves(const DualSample& s, const Step& step) {
  // B's support point is that of -n, whose step is -delta.
  const LaneVector delta = LaneVector::of(step.delta, -step.delta);
  return s.support.t1.dot(delta) * s.support.t1 + s.support.t2.dot(delta) * s.support.t2;
}

LaneVector NormBodyPair::joined(const LaneVector& points, const DualSample& at) const {
  const Vector3d gap = at.g * at.n;
  const Vector3d point_a = points.a() + 0.5 * (r_ + points.b() - points.a() - gap);
  return LaneVector::of(point_a, point_a + gap - r_);
}

/// True if g grows, or stays while the mismatch of the support points falls: near the maximum the growth of g is below
/// rounding.
bool NormBodyPair::improves(const DualSample& from, const DualSample& to) const {
  const double rounding = kGrowth * scale_;
  return to.g >= from.g - rounding && (to.g > from.g + rounding || to.residual < kShrink * from.residual);
}

/// Takes Newton's step with a support point on the surface, and computes the normal there.
bool NormBodyPair::retract(DualSample& s, const Step& step, double cap) const {
  constexpr double kTurned = 0.3;  // smallest cosine between the normals before and after
  constexpr int kMoves = 3;
  const auto take = [&](const Vector3d& n) {
    const DualSample trial = sample(n);
    if (!improves(s, trial)) return false;
    s = trial;
    return true;
  };
  const LaneVector from = s.support.point;
  const LaneVector move = moves(s, step);
  const Lanes traces = s.traces();
  const bool flatter_is_a = traces[0] >= traces[1];
  double fraction = 1;
  for (int k = 0; k < kMoves; ++k, fraction *= kShorterMove) {
    const LaneVector normals = bodies_.normals(from + both(fraction) * move);
    for (const bool by_a : {flatter_is_a, !flatter_is_a}) {
      const Vector3d n = by_a ? normals.a() : Vector3d(-normals.b());
      if (n.dot(s.n) > kTurned && take(n)) return true;
    }
    if (k == 0 && take((s.n + cap * step.delta).normalized())) return true;
  }
  return false;
}

bool NormBodyPair::advance(DualSample& s, const Step& step) const {
  constexpr double kFlat = 0.15;  // trace of H above this fraction of the size: the support point moves far
  constexpr int kShortenings = 18;
  const double length = step.delta.norm();
  const double cap = std::min(1.0, kMaxNormalStep / length);
  const Lanes traces = s.traces();
  if (flat_ && std::max(traces[0], traces[1]) > kFlat * scale_ && retract(s, step, cap)) return true;
  double fraction = cap;
  // A step whose predicted gain is rounding is tried once.
  const int tries = length < kRoundingStep && step.decrement < kRoundingDecrement * scale_ ? 2 : kShortenings;
  for (int k = 0; k < tries; ++k, fraction *= kBacktrack) {
    const DualSample trial = sample((s.n + fraction * step.delta).normalized());
    const bool grows = trial.g >= s.g + (s.g > 0 ? kArmijo * fraction * step.decrement : 0.0);
    if (!(grows && trial.g > s.g) && !improves(s, trial) && !(k == 0 && keeps_promise(s, step, trial))) continue;
    s = trial;
    return true;
  }
  return false;
}

/// True if a step whose predicted gain is too small to show in g is a good one: g has not fallen by more than rounding,
/// and the next predicted gain is less than kPromiseShrink of this one. The support point of a flat body is lost to
/// rounding, and with it the mismatch: neither g nor the mismatch can show that the normal is off by 1e-7 along the
/// direction in which both bodies are round. The next predicted gain can, because flat directions have no weight in it.
bool NormBodyPair::keeps_promise(const DualSample& from, const Step& step, const DualSample& to) const {
  if (step.lifted || !(step.decrement < kHiddenDecrement * scale_)) return false;
  if (!(step.delta.squaredNorm() < kNormalTolerance2) || !(to.g >= from.g - kGrowth * scale_)) return false;
  const Step next = newton_step(to);
  return !next.lifted && next.decrement < kPromiseShrink * step.decrement;
}

/// Moves the points and the normal by the step, and uses the upper bound from the points if rounding keeps the support
/// points apart.
void NormBodyPair::place_points(const Step& step, Answer& answer) const {
  answer.points = moved_points(answer.at, step);
  answer.gap = answer.at.gap();
  if (answer.at.g < -kBoundGap * scale_) return;  // no two points bound the depth of an overlap
  if (!step.lifted && step.delta.squaredNorm() < kNormalTolerance2) {
    answer.at.n = (answer.at.n + step.delta).normalized();
  }
  if (answer.gap < kTightGap * scale_) return;
  const LaneVector on = bodies_.on_surface(answer.points);
  const double gap = (r_ + on.b() - on.a()).norm() - answer.at.g;
  if (!(gap < answer.gap)) return;
  answer.points = on;
  answer.gap = std::max(0.0, gap);
}

NormBodyPair::Answer NormBodyPair::dual(const Vector3d& start, Patience patience, int max_iterations,
                                        int& iterations) const {
  Answer answer;
  answer.at = sample(start);
  double least = answer.at.residual;
  Step step = newton_step(answer.at);
  bool settled = false;  // no step is needed, or none helps
  for (int k = 0; k < max_iterations && !settled; ++k) {
    ++iterations;
    settled = (answer.at.g > 0 && answer.at.gap() < kTightGap * scale_) || answer.at.residual < kTightResidual * scale_;
    if (settled) break;
    if (patience == Patience::little && k >= kTrials && answer.at.residual > kFast * least) return answer;
    least = std::min(least, answer.at.residual);
    settled = !advance(answer.at, step);
    if (!settled) step = newton_step(answer.at);
  }
  place_points(step, answer);
  // For overlaps there is no upper bound: the criterion is the decrement, twice the possible gain of g in its quadratic
  // model. It is meaningless on a flat face, where the model holds for no step, and while steps still help.
  const bool stationary = settled && !(answer.at.g > 0) && answer.at.residual < kSmallResidual * scale_ &&
                          step.decrement < kTightGap * scale_ && !step.lifted;
  // Steps that still help would reduce a wide gap to rounding.
  answer.converged = answer.gap < (settled ? kBoundGap : kTightGap) * scale_ || stationary;
  return answer;
}

Vector3d NormBodyPair::cold_normal() const {
  const Eigen::Matrix3d Q = bodies_.quadrics();
  return unit_or_x(Q.inverse() * r_);
}

Vector3d NormBodyPair::between_balls(const LaneVector& on_surface) const {
  const LaneVector centres = on_surface - rolling_ * bodies_.normals(on_surface);
  return r_ + centres.b() - centres.a();
}

/// Bounds the depth of an overlap by the balls that roll inside the bodies, at the points found.
void NormBodyPair::bound_depth(Answer& answer) const {
  const double rho = sum(rolling_);
  if (!(answer.at.g + rho > 0)) return;
  const double upper = between_balls(bodies_.on_surface(answer.points)).norm() - rho;
  answer.gap = std::min(answer.gap, std::max(0.0, upper - answer.at.g));
}

/// Returns whether an answer of one of the methods ends the query.
bool NormBodyPair::ends(Answer& answer, Penetration penetration) const {
  if (!answer.converged) return false;
  if (!(answer.at.g > 0)) bound_depth(answer);
  if (answer.at.g > 0 || answer.gap < kBoundGap * scale_) return true;
  return penetration == Penetration::local && shares_a_point(answer);
}

bool NormBodyPair::shares_a_point(const Answer& answer) const {
  const auto holds = [this](const Vector3d& p) {
    const Lanes norms = bodies_.norms(LaneVector::of(p, p - r_));
    return norms[0] <= 1 && norms[1] <= 1;
  };
  const LaneVector points = joined(answer.points, answer.at);
  if (holds_between(points.a(), r_ + points.b(), holds)) return true;
  // If any point between the centres is in both bodies, so is the one, t r, with N_A(t r) = N_B((1 - t) r). No norm is
  // beyond kMaxCoordinate / kMinSemiAxis, 1e150, by more than a small factor.
  const Lanes norms = bodies_.norms(LaneVector::of(r_, r_));
  return norms[0] * norms[1] <= norms[0] + norms[1];
}

/// Returns a local maximum of g uphill of n. If the support points still disagree there, on flat faces, it is found by
/// contact elements, whose points bound g around it better than the support points can (kernel/sphere_search.h).
Tangent NormBodyPair::climbed(const Vector3d& n, double rounding, int& iterations) const {
  const Answer by_n = dual(n, Patience::all, kMaxIterations, iterations);
  Tangent top = tangent(by_n.at.n);
  if (!(by_n.at.residual > kStuck * scale_)) return top;
  const Answer by_both = by_elements(by_n.at.n, FirstElements::supports, Pace::brisk, kElementSteps, iterations);
  if (!by_both.converged) return top;
  Tangent other = tangent(by_both.at.n);
  if (!(other.g >= top.g - rounding)) return top;
  other.p = between_balls(bodies_.on_surface(by_both.points)) - sum(rolling_) * other.n;
  return other;
}

/// Runs branch and bound from a normal, which is first raised to a local maximum.
NormBodyPair::Answer NormBodyPair::search(const Vector3d& start, int& iterations) const {
  const auto at = [&](const Vector3d& n) {
    ++iterations;
    return tangent(n);
  };
  const double rounding = kRoundingFactor * scale_;
  const auto climb = [&](const Vector3d& n) { return climbed(n, rounding, iterations); };
  const auto up = [&](const Vector3d& n) { return upward(sample(n), rounding); };
  const auto polish = [&](const Vector3d& n) { return climb_over_saddles(at, climb, up, n, rounding); };
  SphereSearch<decltype(at), decltype(polish)> sphere(at, polish, sum(rolling_), polish(start), rounding);
  sphere.run_to(kDepthGap * scale_, kMostDepthSamples);
  const bool apart = sphere.best().g > 0;
  if (apart) {
    // g is concave there, so it remains to approach its single maximum.
    sphere.run_to(kBoundGap * scale_, kMostDepthSamples);
  } else if ((sphere.best().p - sphere.best().g * sphere.best().n).norm() > kStuck * scale_) {
    // Neither method has reached the maximum, but triangles do.
    sphere.run_to(kStuckDepthGap * scale_, kMostDepthSamples);
  }
  Answer answer;
  answer.at = sample(sphere.best().n);
  place_points(newton_step(answer.at), answer);
  const double searched = std::max(0.0, sphere.upper() - sphere.best().g);
  answer.gap = apart ? std::min(answer.gap, searched) : searched;
  answer.converged = answer.gap < (apart ? kWidestGap : kWidestDepthGap) * scale_;
  return answer;
}

/// Improves an answer of the search. The search ends when its bounds are close, for a distance at kBoundGap if
/// possible; the other methods are then started from its normal. Its upper bound is kept if theirs is no better.
NormBodyPair::Answer NormBodyPair::polished(const Answer& answer, int& iterations) const {
  if (!(answer.gap > kTightGap * scale_)) return answer;
  const bool apart = answer.at.g > 0;
  const double upper = answer.at.g + answer.gap;
  Answer by_both = by_elements(answer.at.n, FirstElements::supports, Pace::careful, kCarefulSteps, iterations);
  if (by_both.converged && (apart ? by_both.gap < answer.gap : by_both.at.g >= answer.at.g - kGrowth * scale_)) {
    if (!apart) by_both.gap = std::max(0.0, upper - by_both.at.g);
    return by_both;
  }
  Answer better = dual(answer.at.n, Patience::all, kMaxIterations, iterations);
  if (!(better.at.g > answer.at.g)) return answer;
  const double kept = std::max(0.0, upper - better.at.g);
  if (kept < better.gap) {
    better.gap = kept;
    if (apart) better.points = answer.points;
  }
  better.converged = true;
  return better;
}

NormBodyPair::Answer NormBodyPair::newton(const Vector3d& start, FirstElements first, int limit,
                                          int& iterations) const {
  if (both_flat_) {
    Answer by_both = by_elements(start, first, Pace::brisk, std::min(kElementSteps, limit), iterations);
    if (by_both.converged) return by_both;
  }
  Answer fast = dual(start, Patience::little, std::min(kPatience, limit), iterations);
  if (fast.converged) return fast;
  Answer by_both =
      by_elements(fast.at.n, FirstElements::supports, Pace::brisk, std::min(kElementSteps, limit), iterations);
  if (by_both.converged) return by_both;
  Answer slow = dual(fast.at.n, Patience::all, std::min(kMorePatience, limit), iterations);
  if (slow.converged) return slow;
  const Answer careful = by_elements(slow.at.n, FirstElements::supports, Pace::careful,
                                     limit < kCarefulSteps / 2 ? 2 * limit : kCarefulSteps, iterations);
  return careful.converged ? careful : slow;
}

NormBodyPair::Answer NormBodyPair::solve(const Vector3d& start, const Vector3d& cold, Penetration penetration,
                                         int max_iterations, int& iterations) const {
  const int limit = std::max(1, max_iterations);
  const bool is_cold = start == cold;
  Answer best = newton(start, is_cold ? FirstElements::ellipsoids : FirstElements::supports, limit, iterations);
  if (ends(best, penetration)) return best;
  // From a normal that is far off, the ascent for bodies apart may also end at g < 0, or nowhere.
  if (!is_cold) {
    Answer from_cold = newton(cold, FirstElements::ellipsoids, limit, iterations);
    if (ends(from_cold, penetration)) return from_cold;
    if (from_cold.at.g > best.at.g) best = from_cold;
  }
  if (both_flat_) {
    // If two maxima are nearly equal, the search may keep the one it begins at: it therefore begins at the highest of
    // those found.
    Answer other = by_elements(cold, FirstElements::supports, Pace::brisk, std::min(kElementSteps, limit), iterations);
    if (ends(other, penetration)) return other;
    if (other.converged && other.at.g > best.at.g) best = other;
  }
  const Answer found = search(best.at.n, iterations);
  return found.converged ? polished(found, iterations) : found;
}

}  // namespace geom::kernel
