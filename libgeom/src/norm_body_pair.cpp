#include <geom/internal/norm_body_pair.h>

#include <geom/internal/dual_newton.h>
#include <geom/internal/small_solve.h>
#include <geom/tolerances.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace geom::internal {
namespace {

using Eigen::Vector3d;

// Lengths are in units of the scale, the sum of both bounding radii, unless something else is said.

/// Bounds this close are as good as it gets: a method ends.
constexpr double kTightGap = 1e-14;
/// The same, of the mismatch of the support points.
constexpr double kTightResidual = 1e-14;
/// What rounding of the support points can leave of their mismatch at the stationary normal of an overlap.
constexpr double kSmallResidual = 1e-8;
/// Mismatch of the support points above which an overlap's normal is no maximum to rounding but stuck beside one ...
constexpr double kStuck = 1e-12;
/// ... and is searched for until no other is better by this.
constexpr double kStuckDepthGap = 1e-12;

/// An ascent: g grows by more than kGrowth, or falls by no more while the mismatch of the support points shrinks to
/// below kShrink of what it was.
constexpr double kGrowth = 1e-15;
constexpr double kShrink = 0.9;
/// A Newton step of the normal (radian) and what it promises: below both there is nothing to gain but rounding.
constexpr double kRoundingStep = 1e-9;
constexpr double kRoundingDecrement = 1e-16;
/// A promise that g may not show; it is kept if what is promised next is less than this share of it.
constexpr double kHiddenDecrement = 1e-14;
constexpr double kPromiseShrink = 0.1;

/// Levenberg's term of the primal method, dimensionless (the Hessian's identity part is 1): where it starts, its range,
/// and how it changes after a step that moves the points and after one that does not.
constexpr double kFirstMu = 1e-9;
constexpr double kLeastMu = 1e-12;
constexpr double kMostMu = 1e-3;
constexpr double kMuAfterMove = 0.1;
constexpr double kMuAfterFailure = 1e3;
/// Longest step of a point in the primal method.
constexpr double kLongestMove = 0.5;
/// By what steps along a surface are shortened. Dimensionless.
constexpr double kShorterMove = 0.4;

/// Steps of the dual method before the primal one is asked, which is faster where edges or vertices meet.
constexpr int kPatience = 9;
/// Steps of the dual method on bodies that overlap, for which it is the only fast one; and on each softened pair.
constexpr int kMorePatience = 25;

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

/// With t_k the vectors of the rank-ones and p_k = n x t_k: det S = sum over k < l of (p_k.t_l)^2, all terms positive,
/// so that nothing cancels where one body is flat and the other is not; the smallest eigenvalue is det S over the
/// largest.
NormBodyPair::TangentMatrix NormBodyPair::tangent_matrix(const DualSample& s) const {
  const LaneVector n = LaneVector::same(s.n);
  TangentMatrix M;
  M.p1 = n.cross(s.support.t1);
  M.p2 = n.cross(s.support.t2);
  const Lanes within = M.p1.dot(s.support.t2);
  const Lanes across11 = M.p1.dot(swapped(s.support.t1));
  const Lanes across12 = M.p1.dot(swapped(s.support.t2));
  const Lanes across22 = M.p2.dot(swapped(s.support.t2));
  const double det = sum(within * within + across12 * across12) + across11[0] * across11[0] + across22[0] * across22[0];
  const double trace = sum(s.traces());
  const double largest = 0.5 * trace + std::sqrt(std::max(0.0, 0.25 * trace * trace - det));
  const double smallest = largest > 0 ? det / largest : 0;
  M.lifted = s.g + smallest < floor_;
  M.identity = M.lifted ? floor_ - smallest : s.g;
  M.determinant = M.identity * (M.identity + trace) + det;
  return M;
}

/// By the adjugate, g I + sum p_k p_k^T.
Vector3d NormBodyPair::TangentMatrix::solve(const Vector3d& y) const {
  const LaneVector up = p1.dot(y) * p1 + p2.dot(y) * p2;
  return (identity * y + up.a() + up.b()) / determinant;
}

Vector3d NormBodyPair::tangent_solve(const DualSample& s, const Vector3d& y) const {
  return tangent_matrix(s).solve(y);
}

/// By the eigenvalues of S + g I.
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
  // Deep in an overlap a step that had to be made definite may lead anywhere.
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

/// g grows, or stays while the mismatch of the support points falls: near the maximum g's growth is below rounding.
bool NormBodyPair::improves(const DualSample& from, const DualSample& to) const {
  const double rounding = kGrowth * scale_;
  return to.g >= from.g - rounding && (to.g > from.g + rounding || to.residual < kShrink * from.residual);
}

/// Newton's step made with a support point on the surface, and the normal read there.
bool NormBodyPair::retract(DualSample& s, const Step& step, double cap) const {
  constexpr double kTurned = 0.3;  // least cosine between the normals before and after
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
  constexpr double kFlat = 0.15;  // trace of H above this share of the size: the support point runs
  constexpr int kShortenings = 18;
  const double length = step.delta.norm();
  const double cap = std::min(1.0, kMaxNormalStep / length);
  const Lanes traces = s.traces();
  if (std::max(traces[0], traces[1]) > kFlat * scale_ && retract(s, step, cap)) return true;
  double fraction = cap;
  // A step whose promise is rounding is tried once.
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

/// Where one body is flat its support point is lost to rounding, and with it the mismatch: neither g nor that can show
/// that the normal is off by 1e-7 along the direction in which both are round. The next promise can, in which flat
/// directions weigh nothing.
bool NormBodyPair::keeps_promise(const DualSample& from, const Step& step, const DualSample& to) const {
  if (step.lifted || !(step.decrement < kHiddenDecrement * scale_)) return false;
  if (!(step.delta.squaredNorm() < kNormalTolerance2) || !(to.g >= from.g - kGrowth * scale_)) return false;
  const Step next = newton_step(to);
  return !next.lifted && next.decrement < kPromiseShrink * step.decrement;
}

/// Moves the points and the normal by the step, and takes the upper bound that the points are where rounding keeps the
/// support points apart.
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

NormBodyPair::Answer NormBodyPair::dual(const Vector3d& start, int max_iterations, int& iterations) const {
  Answer answer;
  answer.at = sample(start);
  Step step = newton_step(answer.at);
  bool settled = false;  // no step is needed, or none helps
  for (int k = 0; k < max_iterations && !settled; ++k) {
    ++iterations;
    settled = (answer.at.g > 0 && answer.at.gap() < kTightGap * scale_) || answer.at.residual < kTightResidual * scale_;
    if (settled) break;
    settled = !advance(answer.at, step);
    if (!settled) step = newton_step(answer.at);
  }
  place_points(step, answer);
  // Of bodies that overlap there is no upper bound: the decrement, twice what g can gain by its quadratic model,
  // decides. It says nothing on a flat face, where the model holds for no step at all, nor while steps still help.
  const bool stationary = settled && !(answer.at.g > 0) && answer.at.residual < kSmallResidual * scale_ &&
                          step.decrement < kTightGap * scale_ && !step.lifted;
  // Steps that still help would take a wide gap to rounding, which is what the next method does.
  answer.converged = answer.gap < (settled ? kBoundGap : kTightGap) * scale_ || stationary;
  return answer;
}

/// Raises `best` to the best lower bound that the two points offer: the normals at them, and their direction.
void NormBodyPair::bound(const Points& points, Answer& best) const {
  const double upper = points.gap.norm();
  const LaneVector normals = bodies_.normals(points.on);
  const Vector3d n_a = normals.a();
  for (const Vector3d& n : {n_a, Vector3d(-normals.b()), upper > 0 ? Vector3d(points.gap / upper) : n_a}) {
    const double lower = r_.dot(n) - sum(bodies_.heights(LaneVector::of(n, -n)));
    if (!(upper - lower < best.gap)) continue;
    best.gap = upper - lower;
    best.at.n = n;
    best.points = points.on;
  }
}

/// The step of both points, in their tangent planes, that minimises the model of |D|^2 / 2: its Hessian is [I + alpha
/// FA, -I; -I, I + beta FB], F the Hessian of the body's norm, positive semidefinite for alpha, beta >= 0.
LaneVector NormBodyPair::primal_step(const Points& points, double mu) const {
  LaneVector gradient, s, t;
  bodies_.derivatives(points.on, gradient, s, t);
  const Lanes gap_along = LaneVector::of(points.gap, -points.gap).dot(gradient) / gradient.dot(gradient);
  const Lanes weight = select(below(gap_along, both(0)), both(0), gap_along);
  const auto [e_a, f_a] = TangentBasis(gradient.a().normalized());
  const auto [e_b, f_b] = TangentBasis(gradient.b().normalized());
  const LaneVector e = LaneVector::of(e_a, e_b);
  const LaneVector f = LaneVector::of(f_a, f_b);
  const Lanes s_e = s.dot(e), s_f = s.dot(f), t_e = t.dot(e), t_f = t.dot(f);
  const Lanes m_ee = 1 + mu + weight * (s_e * s_e + t_e * t_e);
  const Lanes m_ef = weight * (s_e * s_f + t_e * t_f);
  const Lanes m_ff = 1 + mu + weight * (s_f * s_f + t_f * t_f);
  SmallMatrix<4> M;
  M.topLeftCorner<2, 2>() << m_ee[0], m_ef[0], m_ef[0], m_ff[0];
  M.bottomRightCorner<2, 2>() << m_ee[1], m_ef[1], m_ef[1], m_ff[1];
  M.topRightCorner<2, 2>() << -e_a.dot(e_b), -e_a.dot(f_b), -f_a.dot(e_b), -f_a.dot(f_b);
  M.bottomLeftCorner<2, 2>() = M.topRightCorner<2, 2>().transpose();
  const Vector3d& D = points.gap;
  const SmallVector<4> step = solve_small<4>(M, SmallVector<4>(e_a.dot(D), f_a.dot(D), -e_b.dot(D), -f_b.dot(D)));
  return Lanes{step[0], step[2]} * e + Lanes{step[1], step[3]} * f;
}

/// Newton's method for the closest points themselves, with Levenberg's term mu; keeps the best bounds.
NormBodyPair::Answer NormBodyPair::primal(const DualSample& start, int max_iterations, int& iterations) const {
  constexpr int kShortenings = 30;
  const auto points = [this](const LaneVector& x) {
    const LaneVector on = bodies_.on_surface(x);
    return Points{on, r_ + on.b() - on.a()};
  };
  Answer best;
  best.at.n = start.n;
  best.points = start.support.point;
  Points here = points(start.support.point);
  double mu = kFirstMu;
  for (int k = 0; k < max_iterations; ++k) {
    ++iterations;
    bound(here, best);
    if (best.gap < kTightGap * scale_) break;
    const LaneVector step = primal_step(here, mu);
    double fraction = std::min(1.0, kLongestMove * scale_ / std::max(step.a().norm(), step.b().norm()));
    bool moved = false;
    for (int t = 0; t < kShortenings && !moved; ++t, fraction *= kShorterMove) {
      const Points trial = points(here.on + both(fraction) * step);
      moved = trial.gap.norm() < here.gap.norm();
      if (moved) here = trial;
    }
    if (!moved && mu > kMostMu) break;
    mu = moved ? std::max(kMuAfterMove * mu, kLeastMu) : kMuAfterFailure * mu;
  }
  best.at = sample(best.at.n);
  if (best.at.gap() < best.gap) {
    best.gap = best.at.gap();
    best.points = best.at.support.point;
  }
  best.converged = best.gap < kBoundGap * scale_;
  return best;
}

Vector3d NormBodyPair::continued(Vector3d n, int& iterations) const {
  // Of the way from an ellipsoid's exponents to the bodies': shorter steps where the faces become flat.
  for (const double share : {0.3, 0.6, 0.8, 0.9, 0.96}) {
    const NormBodyPair soft(bodies_.softened(share), r_, scale_, floor_ / kFloor);
    n = soft.dual(n, kMorePatience, iterations).at.n;
  }
  return n;
}

Vector3d NormBodyPair::cold_normal() const {
  const Eigen::Matrix3d Q = bodies_.quadrics();
  return unit_or_x(Q.inverse() * r_);
}

/// Whether an answer of one of the methods ends the query.
bool NormBodyPair::ends(const Answer& answer, Penetration penetration) const {
  if (!answer.converged) return false;
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
  // Of the points t r between the centres the one with N_A(t r) = N_B((1 - t) r). No norm is beyond kMaxCoordinate /
  // kMinSemiAxis, 1e150, by more than a small factor.
  const Lanes norms = bodies_.norms(LaneVector::of(r_, r_));
  return norms[0] * norms[1] <= norms[0] + norms[1];
}

/// Branch and bound from the best normal so far, which it raises to a local maximum first.
NormBodyPair::Answer NormBodyPair::search(const DualSample& best, int& iterations) const {
  const auto at = [&](const Vector3d& n) {
    ++iterations;
    return tangent(n);
  };
  const double rounding = kRoundingFactor * scale_;
  const auto climb = [&](const Vector3d& n) { return tangent(dual(n, kMaxIterations, iterations).at.n); };
  const auto up = [&](const Vector3d& n) { return upward(sample(n), rounding); };
  const auto polish = [&](const Vector3d& n) { return climb_over_saddles(at, climb, up, n, rounding); };
  SphereSearch<decltype(at), decltype(polish)> sphere(at, polish, 0, polish(best.n), rounding);
  sphere.run_to(kDepthGap * scale_, kMostDepthSamples);
  const bool apart = sphere.best().g > 0;
  if (apart) {
    // Concave there: what is left is to come close to the one maximum.
    sphere.run_to(kBoundGap * scale_, kMostDepthSamples);
  } else if (sample(sphere.best().n).residual > kStuck * scale_) {
    // Edges on faces: the ascent stops short of the maximum, but triangles do not.
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

/// The other methods end when their bounds are close, a distance to kBoundGap; dual steps take g to rounding.
NormBodyPair::Answer NormBodyPair::polished(const Answer& answer, int& iterations) const {
  if (!(answer.gap > kTightGap * scale_)) return answer;
  Answer better = dual(answer.at.n, kMaxIterations, iterations);
  const double gained = better.at.g - answer.at.g;
  if (!(gained > 0)) return answer;
  const double kept = std::max(0.0, answer.gap - gained);  // the upper bound has not moved
  if (kept < better.gap) {
    better.gap = kept;
    better.points = answer.points;
  }
  better.converged = true;
  return better;
}

NormBodyPair::Answer NormBodyPair::patient_dual(const Vector3d& start, int limit, int& iterations) const {
  Answer answer = dual(start, std::min(kPatience, limit), iterations);
  // Of bodies that overlap it is the only fast method.
  if (!answer.converged && !(answer.at.g > 0)) {
    answer = dual(answer.at.n, std::min(kMorePatience, limit), iterations);
  }
  return answer;
}

NormBodyPair::Answer NormBodyPair::solve(const Vector3d& start, const Vector3d& cold, Penetration penetration,
                                         int max_iterations, int& iterations) const {
  const int limit = std::max(1, max_iterations);
  Answer first = patient_dual(start, limit, iterations);
  if (ends(first, penetration)) return first;
  // From a normal that is far off, bodies that are apart may end where g < 0 too.
  if (first.converged && first.at.g < 0 && start != cold) {
    Answer from_cold = patient_dual(cold, limit, iterations);
    if (ends(from_cold, penetration)) return from_cold;
    if (from_cold.at.g > first.at.g) first = from_cold;
  }
  DualSample best = first.at;
  if (!(first.converged && first.at.g < 0)) {
    Answer by_points = primal(first.at, limit, iterations);
    if (ends(by_points, penetration)) return polished(by_points, iterations);
    Answer again = dual(continued(cold, iterations), 2 * limit, iterations);
    if (ends(again, penetration)) return again;
    Answer last = primal(again.at, 4 * limit, iterations);
    if (ends(last, penetration)) return polished(last, iterations);
    for (const Answer* answer : {&by_points, &again, &last}) {
      if (answer->at.g > best.g) best = answer->at;
    }
  }
  const Answer found = search(best, iterations);
  return found.converged ? polished(found, iterations) : found;
}

}  // namespace geom::internal
