#include "norm_body_pair.h"

#include <geom/tolerances.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>

namespace geom::internal {
namespace {

using Eigen::Vector3d;

constexpr double kTightGap = 1e-14;       ///< in units of the scale: as good as it gets
constexpr double kTightResidual = 1e-14;  ///< the same, of the mismatch of the support points
constexpr double kSmallResidual = 1e-8;   ///< what rounding of the support points can come to

/// An orthonormal basis across n.
void tangent_basis(const Vector3d& n, Vector3d& e, Vector3d& f) {
  e = (std::abs(n.x()) < 0.6 ? Vector3d(0, n.z(), -n.y()) : Vector3d(n.z(), 0, -n.x())).normalized();
  f = n.cross(e);
}

/// v with the signs of `signs`; a component that is zero there has either sign.
Vector3d with_signs(const Vector3d& v, const Vector3d& signs) {
  return {std::copysign(1.0, signs.x()) * v.x(), std::copysign(1.0, signs.y()) * v.y(),
          std::copysign(1.0, signs.z()) * v.z()};
}

}  // namespace

NormBody NormBody::softened(double share) const {
  const auto soft = [share](double e) { return 1 + share * (e - 1); };
  const double e1 = soft(2 / norm_.outer_exponent());
  const double e2 = soft(2 / norm_.inner_exponent());
  return {axes_, NestedNorm(2 / e1, 2 / e2), NestedNorm(2 / (2 - e1), 2 / (2 - e2)), R_};
}

RankedSupport NormBody::support(const Vector3d& n) const {
  const Vector3d v = axes_.cwiseProduct(R_.transpose() * n);
  const NestedNorm::Curved at = dual_.curved(v.cwiseAbs());
  const Vector3d scale = with_signs(axes_, v);
  return {at.norm, R_ * at.gradient.cwiseProduct(scale), R_ * at.across.cwiseProduct(scale),
          R_ * at.along.cwiseProduct(scale)};
}

Vector3d NormBody::normal(const Vector3d& x) const {
  const Vector3d w = (R_.transpose() * x).cwiseQuotient(axes_);
  return (R_ * with_signs(norm_(w.cwiseAbs()).gradient, w).cwiseQuotient(axes_)).normalized();
}

Vector3d NormBody::on_surface(const Vector3d& x) const {
  return x / norm_((R_.transpose() * x).cwiseQuotient(axes_).cwiseAbs()).norm;
}

void NormBody::derivatives(const Vector3d& x, Vector3d& gradient, Vector3d& t1, Vector3d& t2) const {
  const Vector3d w = (R_.transpose() * x).cwiseQuotient(axes_);
  const NestedNorm::Curved at = norm_.curved(w.cwiseAbs());
  const Vector3d scale = with_signs(axes_.cwiseInverse(), w);
  gradient = R_ * at.gradient.cwiseProduct(scale);
  t1 = R_ * at.across.cwiseProduct(scale);
  t2 = R_ * at.along.cwiseProduct(scale);
}

DualSample NormBodyPair::sample(const Vector3d& n) const {
  DualSample s;
  s.n = n;
  s.a = a_.support(n);
  s.b = b_.support(-n);
  s.g = r_.dot(n) - s.a.height - s.b.height;
  const Vector3d gap = r_ - s.a.point + s.b.point;
  s.y = gap - gap.dot(n) * n;
  s.residual = s.y.norm();
  return s;
}

Tangent NormBodyPair::tangent(const Vector3d& n) const {
  const DualSample s = sample(n);
  return {n, r_ - s.a.point + s.b.point, s.g};
}

NormBodyPair::Step NormBodyPair::newton_step(const DualSample& s) const {
  Vector3d e, f;
  tangent_basis(s.n, e, f);
  double m_ee = s.g;
  double m_ff = s.g;
  double m_ef = 0;
  for (const Vector3d* t : {&s.a.t1, &s.a.t2, &s.b.t1, &s.b.t2}) {
    const double t_e = t->dot(e);
    const double t_f = t->dot(f);
    m_ee += t_e * t_e;
    m_ff += t_f * t_f;
    m_ef += t_e * t_f;
  }
  const double half_difference = 0.5 * (m_ee - m_ff);
  const double smallest = 0.5 * (m_ee + m_ff) - std::sqrt(half_difference * half_difference + m_ef * m_ef);
  Step step;
  step.lifted = smallest < floor_;
  if (step.lifted) {
    m_ee += floor_ - smallest;
    m_ff += floor_ - smallest;
  }
  const double y_e = s.y.dot(e);
  const double y_f = s.y.dot(f);
  const double inv_det = 1 / (m_ee * m_ff - m_ef * m_ef);
  const double d_e = (m_ff * y_e - m_ef * y_f) * inv_det;
  const double d_f = (m_ee * y_f - m_ef * y_e) * inv_det;
  step.delta = d_e * e + d_f * f;
  step.decrement = d_e * y_e + d_f * y_f;
  return step;
}

/// g grows, or stays while the mismatch of the support points falls: near the maximum g's growth is below rounding.
bool NormBodyPair::improves(const DualSample& from, const DualSample& to) const {
  const double rounding = 1e-15 * scale_;
  return to.g >= from.g - rounding && (to.g > from.g + rounding || to.residual < 0.9 * from.residual);
}

/// Newton's step made with a support point on the surface, and the normal read there.
bool NormBodyPair::retract(DualSample& s, const Step& step, double cap) const {
  constexpr double kTurned = 0.3;  // least cosine between the normals before and after
  const auto take = [&](const Vector3d& n) {
    const DualSample trial = sample(n);
    if (!improves(s, trial)) return false;
    s = trial;
    return true;
  };
  const Vector3d move_a = s.a.hessian_times(step.delta);
  const Vector3d move_b = -s.b.hessian_times(step.delta);  // B's support point is that of -n, whose step is -delta
  const bool flatter_is_a = s.a.trace() >= s.b.trace();
  double fraction = 1;
  for (int k = 0; k < 3; ++k, fraction *= 0.4) {
    for (const bool by_a : {flatter_is_a, !flatter_is_a}) {
      const Vector3d n = by_a ? a_.normal(s.a.point + fraction * move_a) : -b_.normal(s.b.point + fraction * move_b);
      if (n.dot(s.n) > kTurned && take(n)) return true;
    }
    if (k == 0 && take((s.n + cap * step.delta).normalized())) return true;
  }
  return false;
}

/// One step uphill: retractions first where a face is flat, then Newton's step, shortened; false: none was found.
bool NormBodyPair::advance(DualSample& s, const Step& step) const {
  constexpr double kFlat = 0.15;  // trace of H above this share of the size: the support point runs
  constexpr int kShortenings = 18;
  const double length = step.delta.norm();
  const double cap = std::min(1.0, kMaxNormalStep / length);
  if (std::max(s.a.trace(), s.b.trace()) > kFlat * scale_ && retract(s, step, cap)) return true;
  double fraction = cap;
  // A step whose promise is rounding is tried once.
  const int tries = length < 1e-9 && step.decrement < 1e-16 * scale_ ? 2 : kShortenings;
  for (int k = 0; k < tries; ++k, fraction *= kBacktrack) {
    const DualSample trial = sample((s.n + fraction * step.delta).normalized());
    const bool grows = trial.g >= s.g + (s.g > 0 ? 1e-4 * fraction * step.decrement : 0.0);
    if (!(grows && trial.g > s.g) && !improves(s, trial)) continue;
    s = trial;
    return true;
  }
  return false;
}

NormBodyPair::Answer NormBodyPair::dual(const Vector3d& start, int max_iterations, int& iterations) const {
  Answer answer;
  answer.at = sample(start);
  Step step = newton_step(answer.at);
  for (int k = 0; k < max_iterations; ++k) {
    ++iterations;
    if ((answer.at.g > 0 && answer.at.gap() < kTightGap * scale_) || answer.at.residual < kTightResidual * scale_) {
      break;
    }
    if (!advance(answer.at, step)) break;
    step = newton_step(answer.at);
  }
  answer.gap = answer.at.gap();
  // Where edges nearly touch, rounding of the support points alone can leave a mismatch too large for the bounds: there
  // the decrement, twice what the distance can be above g by the quadratic model of a concave function, decides.
  // A decrement alone says nothing on a flat face, where the model holds for no step at all.
  const bool stationary =
      answer.at.residual < kSmallResidual * scale_ && step.decrement < kTightGap * scale_ && !step.lifted;
  answer.converged = answer.gap < kBoundGap * scale_ || stationary;
  return answer;
}

/// Raises `best` to the best lower bound that the two points offer: the normals at them, and their direction.
void NormBodyPair::bound(const Points& points, Answer& best) const {
  const Vector3d D = points.gap;
  const double upper = D.norm();
  const Vector3d n_a = a_.normal(points.a);
  for (const Vector3d& n : {n_a, Vector3d(-b_.normal(points.b)), Vector3d(upper > 0 ? Vector3d(D / upper) : n_a)}) {
    const double lower = r_.dot(n) - a_.height(n) - b_.height(-n);
    if (!(upper - lower < best.gap)) continue;
    best.gap = upper - lower;
    best.at.n = n;
  }
}

/// The step of both points, in their tangent planes, that minimises the model of |D|^2 / 2: its Hessian is [I + alpha
/// FA, -I; -I, I + beta FB], F the Hessian of the body's norm, positive semidefinite for alpha, beta >= 0.
void NormBodyPair::primal_step(const Points& points, double mu, Vector3d& d_a, Vector3d& d_b) const {
  Vector3d g_a, g_b, s_a, t_a, s_b, t_b, e, f;
  a_.derivatives(points.a, g_a, s_a, t_a);
  b_.derivatives(points.b, g_b, s_b, t_b);
  const double alpha = std::max(0.0, points.gap.dot(g_a) / g_a.squaredNorm());
  const double beta = std::max(0.0, -points.gap.dot(g_b) / g_b.squaredNorm());
  Eigen::Matrix<double, 3, 2> E_a, E_b;
  tangent_basis(g_a.normalized(), e, f);
  E_a << e, f;
  tangent_basis(g_b.normalized(), e, f);
  E_b << e, f;
  const auto curved = [](const Eigen::Matrix<double, 3, 2>& E, const Vector3d& s, const Vector3d& t) {
    const Eigen::Vector2d s_E = E.transpose() * s;
    const Eigen::Vector2d t_E = E.transpose() * t;
    return Eigen::Matrix2d(s_E * s_E.transpose() + t_E * t_E.transpose());
  };
  Eigen::Matrix4d M;
  M.topLeftCorner<2, 2>() = (1 + mu) * Eigen::Matrix2d::Identity() + alpha * curved(E_a, s_a, t_a);
  M.bottomRightCorner<2, 2>() = (1 + mu) * Eigen::Matrix2d::Identity() + beta * curved(E_b, s_b, t_b);
  M.topRightCorner<2, 2>() = -E_a.transpose() * E_b;
  M.bottomLeftCorner<2, 2>() = M.topRightCorner<2, 2>().transpose();
  Eigen::Vector4d downhill;
  downhill << E_a.transpose() * points.gap, -E_b.transpose() * points.gap;
  const Eigen::Vector4d step = M.partialPivLu().solve(downhill);
  d_a = E_a * step.head<2>();
  d_b = E_b * step.tail<2>();
}

/// Newton's method for the closest points themselves, with Levenberg's term mu; keeps the best bounds.
NormBodyPair::Answer NormBodyPair::primal(const DualSample& start, int max_iterations, int& iterations) const {
  constexpr double kLeastMu = 1e-12;
  constexpr double kMostMu = 1e-3;
  const auto points = [this](const Vector3d& x_a, const Vector3d& x_b) {
    const Points p{a_.on_surface(x_a), b_.on_surface(x_b), Vector3d::Zero()};
    return Points{p.a, p.b, r_ + p.b - p.a};
  };
  Answer best;
  best.at.n = start.n;
  Points here = points(start.a.point, start.b.point);
  double mu = 1e-9;
  for (int k = 0; k < max_iterations; ++k) {
    ++iterations;
    bound(here, best);
    if (best.gap < kTightGap * scale_) break;
    Vector3d d_a, d_b;
    primal_step(here, mu, d_a, d_b);
    double fraction = std::min(1.0, 0.5 * scale_ / std::max(d_a.norm(), d_b.norm()));
    bool moved = false;
    for (int t = 0; t < 30 && !moved; ++t, fraction *= 0.4) {
      const Points trial = points(here.a + fraction * d_a, here.b + fraction * d_b);
      moved = trial.gap.norm() < here.gap.norm();
      if (moved) here = trial;
    }
    if (!moved && mu > kMostMu) break;
    mu = moved ? std::max(0.1 * mu, kLeastMu) : 1e3 * mu;
  }
  best.at = sample(best.at.n);
  best.gap = std::min(best.gap, best.at.gap());
  best.converged = best.gap < kBoundGap * scale_;
  return best;
}

Vector3d NormBodyPair::continued(Vector3d n, int& iterations) const {
  for (const double share : {0.3, 0.6, 0.8, 0.9, 0.96}) {
    const NormBodyPair soft(a_.softened(share), b_.softened(share), r_, scale_, floor_ / 5e-4);
    n = soft.dual(n, 25, iterations).at.n;
  }
  return n;
}

}  // namespace geom::internal
