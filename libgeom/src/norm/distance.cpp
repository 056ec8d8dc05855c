#include <geom/distance.h>
#include <geom/kernel/norm_body_pair.h>
#include <geom/tolerances.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace geom {
namespace {

using Eigen::Vector3d;
using kernel::DualSample;
using kernel::Lanes;
using kernel::NormBodies;
using kernel::NormBodyPair;
using PairAnswer = NormBodyPair::Answer;

template <class A, class B>
DistanceResult norm_body_distance(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB,
                                  const DistanceOptions& options) {
  const Vector3d r = X_WB.position() - X_WA.position();
  const NormBodyPair pair(NormBodies(kernel::NormShape(a), X_WA.rotation(), kernel::NormShape(b), X_WB.rotation()), r,
                          a.bounding_radius() + b.bounding_radius(), a.inscribed_radius() + b.inscribed_radius(),
                          Lanes{a.min_curvature_radius(), b.min_curvature_radius()});
  DistanceResult result;
  const Vector3d cold = pair.cold_normal();
  const PairAnswer answer =
      pair.solve(kernel::is_warm(options.start) ? Vector3d(options.start / options.start.norm()) : cold, cold,
                 options.penetration, options.max_iterations, result.iterations);
  if (!answer.converged) return result;
  const DualSample& at = answer.at;
  result.distance = at.g;
  result.normal = at.n;
  const Vector3d on_a = pair.joined(answer.points, at).a();
  result.point_a = X_WA.position() + on_a;
  result.point_b = result.point_a + at.g * at.n;
  result.residual = 2 * (on_a - answer.points.a()).norm();  // each point has moved half of it
  const bool bounded = at.g > 0 || answer.gap < kWidestDepthGap * pair.scale();
  // The upper bound can be below g by rounding.
  result.error_bound = bounded ? std::max(0.0, answer.gap) : std::numeric_limits<double>::infinity();
  result.status = at.g >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  return result;
}

}  // namespace

DistanceResult distance(const Superellipsoid& a, const Pose& X_WA, const Superellipsoid& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  if (a.is_ellipsoid()) return distance(Ellipsoid(a.semi_axes()), X_WA, b, X_WB, options);
  if (b.is_ellipsoid()) return distance(a, X_WA, Ellipsoid(b.semi_axes()), X_WB, options);
  return norm_body_distance(a, X_WA, b, X_WB, options);
}

DistanceResult distance(const Superellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  if (a.is_ellipsoid()) return distance(Ellipsoid(a.semi_axes()), X_WA, b, X_WB, options);
  return norm_body_distance(a, X_WA, b, X_WB, options);
}

DistanceResult distance(const Ellipsoid& a, const Pose& X_WA, const Superellipsoid& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  if (b.is_ellipsoid()) return distance(a, X_WA, Ellipsoid(b.semi_axes()), X_WB, options);
  return norm_body_distance(a, X_WA, b, X_WB, options);
}

}  // namespace geom
