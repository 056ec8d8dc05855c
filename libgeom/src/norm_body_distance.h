#pragma once

/// Distance of two norm bodies {x : N(x) <= 1} whose surfaces may have flat faces or edges: superellipsoids, and
/// ellipsoids against them.
///
/// Where a face is nearly flat its support point runs across it while n hardly turns, and Newton's step of n
/// overshoots. The remedies, each tried only where the one before has not ended:
///
/// 1. Dual Newton (see internal/dual_newton.h), each step of which may be a *retraction*: the step is made with the
///    support point of the flatter body, s + H delta, where the problem is well scaled, and the normal is read there.
/// 2. Primal Newton on |r + xB - xA|^2 in the two tangent planes, whose Hessian is positive semidefinite for bodies
/// apart.
/// 3. Continuation in the exponents, from nearly ellipsoids to the bodies.
///
/// What is certified: g(n) is a lower bound of the distance for every n, and |r + xB - xA| an upper one for every two
/// points of the bodies. An answer `separated` has both, and they differ by less than kBoundGap of the size.

#include <geom/distance.h>
#include <geom/internal/distance_impl.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace geom::internal {

/// A shape in world axes about its own centre.
template <class Shape>
struct NormBody {
  const Shape& shape;
  const Eigen::Matrix3d& R;

  CurvedSupport support(const Eigen::Vector3d& n) const { return WorldSupport<Shape>{shape, R}(n); }
  double height(const Eigen::Vector3d& n) const { return Support(shape.support(R.transpose() * n)).height; }
  /// The outward normal of the surface at x, or at the surface point in the direction of x: N is homogeneous.
  Eigen::Vector3d normal(const Eigen::Vector3d& x) const {
    return (R * shape.gradient(R.transpose() * x)).normalized();
  }
  Eigen::Vector3d on_surface(const Eigen::Vector3d& x) const {
    return x / std::sqrt(1 + shape.value(R.transpose() * x));
  }
  /// grad N and hess N at a point of the surface; value = N^2 - 1.
  void derivatives(const Eigen::Vector3d& x, Eigen::Vector3d& gradient, Eigen::Matrix3d& hessian) const {
    const Eigen::Vector3d x_body = R.transpose() * x;
    const Eigen::Vector3d g = 0.5 * shape.gradient(x_body);
    gradient = R * g;
    hessian = R * (0.5 * shape.hessian(x_body) - g * g.transpose()) * R.transpose();
  }
};

/// g and all that goes with it at one normal.
struct DualSample {
  Eigen::Vector3d n;
  double g;
  CurvedSupport a, b;  ///< of A at n and of B at -n
  Eigen::Vector3d y;   ///< the gradient of g along the sphere: the mismatch of the support points
  double residual;     ///< |y|

  /// How far g can be below the distance: the support points are hypot(g, |y|) apart, and the distance of bodies that
  /// overlap is below 0.
  double gap() const {
    const double upper = std::hypot(g, residual);
    return g > 0 ? residual * residual / (upper + g) : upper - g;
  }
};

struct DualStep {
  Eigen::Vector3d delta;
  double decrement;
  bool lifted;  ///< the matrix had to be made definite: the step promises nothing
};

/// An orthonormal basis across n.
inline void tangent_basis(const Eigen::Vector3d& n, Eigen::Vector3d& e, Eigen::Vector3d& f) {
  e = (std::abs(n.x()) < 0.6 ? Eigen::Vector3d(0, n.z(), -n.y()) : Eigen::Vector3d(n.z(), 0, -n.x())).normalized();
  f = n.cross(e);
}

template <class ShapeA, class ShapeB>
class NormBodyPair {
 public:
  NormBodyPair(const ShapeA& a, const Eigen::Matrix3d& R_a, const ShapeB& b, const Eigen::Matrix3d& R_b,
               const Eigen::Vector3d& r)
      : a_{a, R_a},
        b_{b, R_b},
        r_(r),
        scale_(a.bounding_radius() + b.bounding_radius()),
        floor_(5e-4 * (a.inscribed_radius() + b.inscribed_radius())) {}

  struct Answer {
    DualSample at;
    double gap = std::numeric_limits<double>::infinity();  ///< certified: at.g <= distance <= at.g + gap
    bool converged = false;                                ///< gap < kBoundGap * scale, or g is stationary to rounding
  };

  Answer dual(const Eigen::Vector3d& start, int max_iterations, int& iterations) const;
  Answer primal(const DualSample& start, int max_iterations, int& iterations) const;
  DualSample sample(const Eigen::Vector3d& n) const;
  double scale() const { return scale_; }

 private:
  static constexpr double kTightGap = 1e-14;       ///< in units of the scale: as good as it gets
  static constexpr double kTightResidual = 1e-14;  ///< the same, of the mismatch of the support points
  static constexpr double kSmallResidual = 1e-8;   ///< what rounding of the support points can come to

  /// Points on both surfaces, from their centres, and the vector between them.
  struct Points {
    Eigen::Vector3d a, b, gap;
  };

  DualStep newton_step(const DualSample& s) const;
  bool advance(DualSample& s, const DualStep& step) const;
  void bound(const Points& points, Answer& best) const;
  void primal_step(const Points& points, double mu, Eigen::Vector3d& d_a, Eigen::Vector3d& d_b) const;
  bool improves(const DualSample& from, const DualSample& to) const;
  Eigen::Vector3d retracted(const DualSample& s, const Eigen::Vector3d& delta, bool by_a, double fraction) const;

  NormBody<ShapeA> a_;
  NormBody<ShapeB> b_;
  Eigen::Vector3d r_;
  double scale_;
  double floor_;  ///< least eigenvalue of Newton's matrix
};

template <class A, class B>
DualSample NormBodyPair<A, B>::sample(const Eigen::Vector3d& n) const {
  DualSample s;
  s.n = n;
  s.a = a_.support(n);
  s.b = b_.support(-n);
  s.g = r_.dot(n) - s.a.height - s.b.height;
  const Eigen::Vector3d gap = r_ - s.a.point + s.b.point;
  s.y = gap - gap.dot(n) * n;
  s.residual = s.y.norm();
  return s;
}

template <class A, class B>
DualStep NormBodyPair<A, B>::newton_step(const DualSample& s) const {
  Eigen::Vector3d e, f;
  tangent_basis(s.n, e, f);
  const Eigen::Matrix3d H = s.a.hessian + s.b.hessian;
  double m_ee = e.dot(H * e) + s.g;
  double m_ff = f.dot(H * f) + s.g;
  const double m_ef = f.dot(H * e);
  const double smallest = 0.5 * (m_ee + m_ff) - std::hypot(0.5 * (m_ee - m_ff), m_ef);
  DualStep step;
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
template <class A, class B>
bool NormBodyPair<A, B>::improves(const DualSample& from, const DualSample& to) const {
  const double rounding = 1e-15 * scale_;
  return to.g >= from.g - rounding && (to.g > from.g + rounding || to.residual < 0.9 * from.residual);
}

template <class A, class B>
Eigen::Vector3d NormBodyPair<A, B>::retracted(const DualSample& s, const Eigen::Vector3d& delta, bool by_a,
                                              double fraction) const {
  // B's support point is that of -n, whose step is -delta.
  if (by_a) return a_.normal(s.a.point + fraction * (s.a.hessian * delta));
  return -b_.normal(s.b.point - fraction * (s.b.hessian * delta));
}

/// One step uphill: retractions first where a face is flat, then Newton's step, shortened; false: none was found.
template <class A, class B>
bool NormBodyPair<A, B>::advance(DualSample& s, const DualStep& step) const {
  constexpr double kFlat = 0.15;   // trace of H above this share of the size: the support point runs
  constexpr double kTurned = 0.3;  // least cosine between the normals before and after
  constexpr int kShortenings = 18;
  const auto take = [&](const Eigen::Vector3d& n) {
    const DualSample trial = sample(n);
    if (!improves(s, trial)) return false;
    s = trial;
    return true;
  };
  const double length = step.delta.norm();
  const double cap = std::min(1.0, kMaxNormalStep / length);
  const double curved_a = s.a.hessian.trace();
  const double curved_b = s.b.hessian.trace();
  double fraction = 1;
  if (std::max(curved_a, curved_b) > kFlat * scale_) {
    const bool flatter_is_a = curved_a >= curved_b;
    for (int k = 0; k < 3; ++k, fraction *= 0.4) {
      for (const bool by_a : {flatter_is_a, !flatter_is_a}) {
        const Eigen::Vector3d n = retracted(s, step.delta, by_a, fraction);
        if (n.dot(s.n) > kTurned && take(n)) return true;
      }
      if (k == 0 && take((s.n + cap * step.delta).normalized())) return true;
    }
  }
  fraction = cap;
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

template <class A, class B>
typename NormBodyPair<A, B>::Answer NormBodyPair<A, B>::dual(const Eigen::Vector3d& start, int max_iterations,
                                                             int& iterations) const {
  Answer answer;
  answer.at = sample(start);
  DualStep step = newton_step(answer.at);
  for (int k = 0; k < max_iterations; ++k) {
    ++iterations;
    if (answer.at.gap() < kTightGap * scale_ || answer.at.residual < kTightResidual * scale_) break;
    if (!advance(answer.at, step)) break;
    step = newton_step(answer.at);
  }
  answer.gap = answer.at.gap();
  // Where edges nearly touch, rounding of the support points alone can leave a mismatch too large for the bounds: there
  // the decrement, twice what the distance can be above g by the quadratic model of a concave function, decides.
  // A decrement alone says nothing on a flat face, where the model holds for no step at all.
  const bool stationary = answer.at.g > 0 && answer.at.residual < kSmallResidual * scale_ &&
                          step.decrement < kTightGap * scale_ && !step.lifted;
  answer.converged = answer.gap < kBoundGap * scale_ || stationary;
  return answer;
}

/// Raises `best` to the best lower bound that the two points offer: the normals at them, and their direction.
template <class A, class B>
void NormBodyPair<A, B>::bound(const Points& points, Answer& best) const {
  const Eigen::Vector3d D = points.gap;
  const double upper = D.norm();
  const Eigen::Vector3d n_a = a_.normal(points.a);
  for (const Eigen::Vector3d& n :
       {n_a, Eigen::Vector3d(-b_.normal(points.b)), Eigen::Vector3d(upper > 0 ? Eigen::Vector3d(D / upper) : n_a)}) {
    const double lower = r_.dot(n) - a_.height(n) - b_.height(-n);
    if (!(upper - lower < best.gap)) continue;
    best.gap = upper - lower;
    best.at.n = n;
  }
}

/// The step of both points, in their tangent planes, that minimises the model of |D|^2 / 2: its Hessian is [I + alpha
/// FA, -I; -I, I + beta FB], F the Hessian of the body's norm, positive semidefinite for alpha, beta >= 0.
template <class A, class B>
void NormBodyPair<A, B>::primal_step(const Points& points, double mu, Eigen::Vector3d& d_a,
                                     Eigen::Vector3d& d_b) const {
  Eigen::Vector3d g_a, g_b, e, f;
  Eigen::Matrix3d h_a, h_b;
  a_.derivatives(points.a, g_a, h_a);
  b_.derivatives(points.b, g_b, h_b);
  const double alpha = std::max(0.0, points.gap.dot(g_a) / g_a.squaredNorm());
  const double beta = std::max(0.0, -points.gap.dot(g_b) / g_b.squaredNorm());
  Eigen::Matrix<double, 3, 2> E_a, E_b;
  tangent_basis(g_a.normalized(), e, f);
  E_a << e, f;
  tangent_basis(g_b.normalized(), e, f);
  E_b << e, f;
  Eigen::Matrix4d M;
  M.topLeftCorner<2, 2>() = (1 + mu) * Eigen::Matrix2d::Identity() + alpha * E_a.transpose() * h_a * E_a;
  M.bottomRightCorner<2, 2>() = (1 + mu) * Eigen::Matrix2d::Identity() + beta * E_b.transpose() * h_b * E_b;
  M.topRightCorner<2, 2>() = -E_a.transpose() * E_b;
  M.bottomLeftCorner<2, 2>() = M.topRightCorner<2, 2>().transpose();
  Eigen::Vector4d downhill;
  downhill << E_a.transpose() * points.gap, -E_b.transpose() * points.gap;
  const Eigen::Vector4d step = M.partialPivLu().solve(downhill);
  d_a = E_a * step.head<2>();
  d_b = E_b * step.tail<2>();
}

/// Newton's method for the closest points themselves, with Levenberg's term mu; keeps the best bounds.
template <class A, class B>
typename NormBodyPair<A, B>::Answer NormBodyPair<A, B>::primal(const DualSample& start, int max_iterations,
                                                               int& iterations) const {
  constexpr double kLeastMu = 1e-12;
  constexpr double kMostMu = 1e-3;
  const auto points = [this](const Eigen::Vector3d& x_a, const Eigen::Vector3d& x_b) {
    const Points p{a_.on_surface(x_a), b_.on_surface(x_b), Eigen::Vector3d::Zero()};
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
    Eigen::Vector3d d_a, d_b;
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

}  // namespace geom::internal
