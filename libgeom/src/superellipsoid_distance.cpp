#include "norm_body_distance.h"

#include <geom/distance.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace geom {
namespace {

using Eigen::Vector3d;
using internal::NormBodyPair;

/// The same body with exponents drawn towards those of an ellipsoid; share 1: the body itself.
Superellipsoid softened(const Superellipsoid& s, double share) {
  return Superellipsoid(s.semi_axes(), 1 + share * (s.e1() - 1), 1 + share * (s.e2() - 1));
}
const Ellipsoid& softened(const Ellipsoid& e, double /*share*/) {
  return e;
}

/// Exact for ellipsoids whose axes are parallel: n along (QA + QB)^-1 r.
template <class A, class B>
Vector3d cold_normal(const A& a, const Eigen::Matrix3d& R_a, const B& b, const Eigen::Matrix3d& R_b,
                     const Vector3d& r) {
  const Eigen::Matrix3d Q = R_a * a.semi_axes().cwiseAbs2().asDiagonal() * R_a.transpose() +
                            R_b * b.semi_axes().cwiseAbs2().asDiagonal() * R_b.transpose();
  const Vector3d n = Q.inverse() * r;
  return n.squaredNorm() > 0 ? n.normalized() : Vector3d::UnitX();
}

template <class A, class B>
struct Query {
  const A& a;
  const Pose& X_WA;
  const B& b;
  const Pose& X_WB;
  Vector3d r;

  using Answer = typename NormBodyPair<A, B>::Answer;

  NormBodyPair<A, B> pair() const { return {a, X_WA.rotation(), b, X_WB.rotation(), r}; }

  /// The normal of bodies that grow from nearly ellipsoids to these.
  Vector3d continued(Vector3d n, int& iterations) const {
    for (const double share : {0.3, 0.6, 0.8, 0.9, 0.96}) {
      const A soft_a = softened(a, share);
      const B soft_b = softened(b, share);
      n = NormBodyPair<A, B>(soft_a, X_WA.rotation(), soft_b, X_WB.rotation(), r).dual(n, 25, iterations).at.n;
    }
    return n;
  }

  Answer solve(const Vector3d& start, int max_iterations, int& iterations) const {
    const NormBodyPair<A, B> bodies = pair();
    const Answer dual = bodies.dual(start, std::min(25, max_iterations), iterations);
    if (dual.converged) return dual;
    const Answer primal = bodies.primal(dual.at, max_iterations, iterations);
    if (primal.converged) return primal;
    const Vector3d cold = cold_normal(a, X_WA.rotation(), b, X_WB.rotation(), r);
    const Answer again = bodies.dual(continued(cold, iterations), 2 * max_iterations, iterations);
    if (again.converged) return again;
    return bodies.primal(again.at, 4 * max_iterations, iterations);
  }
};

template <class A, class B>
DistanceResult norm_body_distance(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB,
                                  const DistanceOptions& options) {
  const Query<A, B> query{a, X_WA, b, X_WB, X_WB.position() - X_WA.position()};
  const double start2 = options.start.squaredNorm();
  const bool warm = start2 > 1e-290 && std::isfinite(start2);
  const Vector3d start =
      warm ? Vector3d(options.start / std::sqrt(start2)) : cold_normal(a, X_WA.rotation(), b, X_WB.rotation(), query.r);
  DistanceResult result;
  const auto answer = query.solve(start, std::max(1, options.max_iterations), result.iterations);
  if (!answer.converged) return result;
  const internal::DualSample& at = answer.at;
  result.distance = at.g;
  result.normal = at.n;
  result.point_a = X_WA.position() + at.a.point + 0.5 * at.y;
  result.point_b = result.point_a + at.g * at.n;
  result.residual = at.residual;
  result.status = at.g >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  return result;
}

}  // namespace

DistanceResult distance(const Superellipsoid& a, const Pose& X_WA, const Superellipsoid& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  return norm_body_distance(a, X_WA, b, X_WB, options);
}

DistanceResult distance(const Superellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  return norm_body_distance(a, X_WA, b, X_WB, options);
}

DistanceResult distance(const Ellipsoid& a, const Pose& X_WA, const Superellipsoid& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  return norm_body_distance(a, X_WA, b, X_WB, options);
}

}  // namespace geom
