#include "norm_body_pair.h"

#include <geom/distance.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace geom {
namespace {

using Eigen::Vector3d;
using internal::DualSample;
using internal::NormBodies;
using internal::NormBodyPair;
using Answer = NormBodyPair::Answer;

/// Exact for ellipsoids whose axes are parallel: n along (QA + QB)^-1 r.
Vector3d cold_normal(const Vector3d& axes_a, const Eigen::Matrix3d& R_a, const Vector3d& axes_b,
                     const Eigen::Matrix3d& R_b, const Vector3d& r) {
  const Eigen::Matrix3d Q =
      R_a * axes_a.cwiseAbs2().asDiagonal() * R_a.transpose() + R_b * axes_b.cwiseAbs2().asDiagonal() * R_b.transpose();
  const Vector3d n = Q.inverse() * r;
  return n.squaredNorm() > 0 ? n.normalized() : Vector3d::UnitX();
}

/// Whether an answer of one of the methods ends the query.
bool ends(const Answer& answer, const NormBodyPair& pair, const DistanceOptions& options) {
  if (!answer.converged) return false;
  return answer.at.g > 0 || answer.gap < kBoundGap * pair.scale() || options.penetration == Penetration::local;
}

constexpr double kSharp = 1e-12;          ///< mismatch of support points that Newton's method leaves at most
constexpr double kSharpDepthGap = 1e-12;  ///< both in units of the pair's scale

/// Steps of the dual method before the primal one is asked, which is faster where edges or vertices meet.
constexpr int kPatience = 9;

/// Branch and bound from the best normal so far, which it raises to a local maximum first.
Answer search(const NormBodyPair& pair, const DualSample& best, int& iterations) {
  const auto sample = [&pair](const Vector3d& n) { return pair.tangent(n); };
  const auto polish = [&](const Vector3d& n) { return pair.tangent(pair.dual(n, kMaxIterations, iterations).at.n); };
  internal::SphereSearch<decltype(sample), decltype(polish)> sphere(sample, polish, 0, pair.tangent(best.n));
  sphere.run_to(kDepthGap * pair.scale(), kMostDepthSamples);
  const bool apart = sphere.best().g > 0;
  if (apart) {
    // Concave there: what is left is to come close to the one maximum.
    sphere.run_to(kBoundGap * pair.scale(), kMostDepthSamples);
  } else if (pair.sample(sphere.best().n).residual > kSharp * pair.scale()) {
    // Edges on faces: the ascent stops short of the maximum, but triangles do not.
    sphere.run_to(kSharpDepthGap * pair.scale(), kMostDepthSamples);
  }
  iterations += sphere.samples();
  Answer answer;
  answer.at = pair.sample(sphere.best().n);
  answer.gap = sphere.upper() - sphere.best().g;
  if (apart) answer.gap = std::min(answer.gap, answer.at.gap());
  answer.converged = answer.gap < (apart ? kWidestGap : kWidestDepthGap) * pair.scale();
  return answer;
}

Answer solve(const NormBodyPair& pair, const Vector3d& start, const Vector3d& cold, const DistanceOptions& options,
             int& iterations) {
  const int limit = std::max(1, options.max_iterations);
  Answer dual = pair.dual(start, std::min(kPatience, limit), iterations);
  // Of bodies that overlap it is the only fast method.
  if (!dual.converged && !(dual.at.g > 0)) dual = pair.dual(dual.at.n, std::min(25, limit), iterations);
  if (ends(dual, pair, options)) return dual;
  DualSample best = dual.at;
  if (!(dual.converged && dual.at.g < 0)) {
    Answer primal = pair.primal(dual.at, limit, iterations);
    if (ends(primal, pair, options)) return primal;
    Answer again = pair.dual(pair.continued(cold, iterations), 2 * limit, iterations);
    if (ends(again, pair, options)) return again;
    Answer last = pair.primal(again.at, 4 * limit, iterations);
    if (ends(last, pair, options)) return last;
    for (const Answer* answer : {&primal, &again, &last}) {
      if (answer->at.g > best.g) best = answer->at;
    }
  }
  return search(pair, best, iterations);
}

template <class A, class B>
DistanceResult norm_body_distance(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB,
                                  const DistanceOptions& options) {
  const Vector3d r = X_WB.position() - X_WA.position();
  const NormBodyPair pair(NormBodies(internal::NormShape(a), X_WA.rotation(), internal::NormShape(b), X_WB.rotation()),
                          r, a.bounding_radius() + b.bounding_radius(), a.inscribed_radius() + b.inscribed_radius());
  const Vector3d cold = cold_normal(a.semi_axes(), X_WA.rotation(), b.semi_axes(), X_WB.rotation(), r);
  const double start2 = options.start.squaredNorm();
  const bool warm = start2 > 1e-290 && std::isfinite(start2);
  DistanceResult result;
  const Answer answer =
      solve(pair, warm ? Vector3d(options.start / std::sqrt(start2)) : cold, cold, options, result.iterations);
  if (!answer.converged) return result;
  const DualSample& at = answer.at;
  result.distance = at.g;
  result.normal = at.n;
  result.point_a = X_WA.position() + at.support.point.a() + 0.5 * at.y;
  result.point_b = result.point_a + at.g * at.n;
  result.residual = at.residual;
  result.error_bound =
      at.g > 0 || answer.gap < kWidestDepthGap * pair.scale() ? answer.gap : std::numeric_limits<double>::infinity();
  result.status = at.g >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  return result;
}

bool is_ellipsoid(const Superellipsoid& s) {
  return s.e1() == 1 && s.e2() == 1;
}

}  // namespace

DistanceResult distance(const Superellipsoid& a, const Pose& X_WA, const Superellipsoid& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  if (is_ellipsoid(a)) return distance(Ellipsoid(a.semi_axes()), X_WA, b, X_WB, options);
  if (is_ellipsoid(b)) return distance(a, X_WA, Ellipsoid(b.semi_axes()), X_WB, options);
  return norm_body_distance(a, X_WA, b, X_WB, options);
}

DistanceResult distance(const Superellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  if (is_ellipsoid(a)) return distance(Ellipsoid(a.semi_axes()), X_WA, b, X_WB, options);
  return norm_body_distance(a, X_WA, b, X_WB, options);
}

DistanceResult distance(const Ellipsoid& a, const Pose& X_WA, const Superellipsoid& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  if (is_ellipsoid(b)) return distance(a, X_WA, Ellipsoid(b.semi_axes()), X_WB, options);
  return norm_body_distance(a, X_WA, b, X_WB, options);
}

}  // namespace geom
