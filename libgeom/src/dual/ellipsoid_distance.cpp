#include "dual/ellipsoid_pair.h"
#include "dual/spheroid_pair.h"

#include <geom/distance.h>
#include <geom/kernel/perram_wertheim.h>

#include <cmath>

namespace geom {
namespace {

using kernel::EllipsoidPair;
using kernel::PairScale;
using kernel::Spheroid;
using kernel::SpheroidPair;

Spheroid spheroid(const Ellipsoid& shape, int axis) {
  return {shape.semi_axes()[axis], shape.semi_axes()[axis == 0 ? 1 : 0], shape.min_curvature_radius()};
}

DistanceResult uniaxial_distance(const Ellipsoid& a, const Pose& X_WA, int axis_a, const Ellipsoid& b, const Pose& X_WB,
                                 int axis_b, const Eigen::Vector3d& r, const PairScale& scale,
                                 const DistanceOptions& options) {
  const SpheroidPair pair(spheroid(a, axis_a), spheroid(b, axis_b), r, X_WA.rotation().col(axis_a),
                          X_WB.rotation().col(axis_b));
  const auto cold = [&] { return pair.start_normal(); };
  const auto shares = [&](const Eigen::Vector3d& point_a, const Eigen::Vector3d& point_b) {
    return kernel::share_a_point(a, X_WA, b, X_WB, point_a, point_b);
  };
  return kernel::solve_dual(pair, cold, scale, X_WA.position(), options, shares);
}

DistanceResult general_distance(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                                const Eigen::Vector3d& r, const PairScale& scale, const DistanceOptions& options) {
  const EllipsoidPair pair(a, X_WA, b, X_WB, r);
  const auto cold = [&] { return pair.start_normal(); };
  const auto shares = [&](const Eigen::Vector3d& point_a, const Eigen::Vector3d& point_b) {
    return kernel::share_a_point(a, X_WA, b, X_WB, point_a, point_b);
  };
  return kernel::solve_dual(pair, cold, scale, X_WA.position(), options, shares);
}

/// Ascends by Newton's method with Armijo's rule. g never falls: from a normal with g > 0 the ascent stays where M + g
/// I is positive definite and the only stationary point is the answer. From a normal with g < 0 it may end at a
/// stationary point that is too deep to be certified.
DistanceResult armijo_ascent(const EllipsoidPair& pair, Eigen::Vector3d n, const PairScale& scale,
                             const Eigen::Vector3d& p_WA, DistanceResult declined) {
  const double rounding = kRoundingFactor * scale.size;
  auto e = pair(n);
  ++declined.iterations;
  for (int newton = 0; newton < kMaxArmijoSteps; ++newton) {
    if (converged(e)) {
      if (e.g < -scale.certified_depth - rounding) return declined;
      DistanceResult result =
          kernel::witness_result(pair, p_WA, kernel::step_on_sphere(n, e.step), declined.iterations);
      result.error_bound = kernel::newton_error_bound(scale, result);
      return result;
    }
    double t = 1;
    while (true) {
      const Eigen::Vector3d trial = (n + t * e.step).normalized();
      const auto e_trial = pair(trial);
      ++declined.iterations;
      if (e_trial.g >= e.g + kArmijo * t * e.decrement - rounding) {
        n = trial;
        e = e_trial;
        break;
      }
      t *= 0.5;
      if (t < kLeastArmijoStep) return declined;
    }
  }
  return declined;
}

DistanceResult deep_distance(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                             const Eigen::Vector3d& r, const PairScale& scale, const DistanceResult& declined) {
  return kernel::search_sphere(EllipsoidPair(a, X_WA, b, X_WB, r), scale, kernel::unit_or_x(r), X_WA.position(),
                               declined.iterations, kernel::common_axis(a, X_WA.rotation(), b, X_WB.rotation()));
}

}  // namespace

namespace kernel {

DistanceResult perram_wertheim_distance(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                                        int iterations_before) {
  DistanceResult declined;
  declined.iterations = iterations_before;
  const Eigen::Vector3d r = X_WB.position() - X_WA.position();
  const EllipsoidPair pair(a, X_WA, b, X_WB, r);
  const ContactFunction contact = perram_wertheim(pair.quadric(0), pair.quadric(1), r);
  const double rho = a.min_curvature_radius() + b.min_curvature_radius();
  // Scaled by sqrt F the bodies touch, so that the depth is at least this. F itself is no test: its rounding error is
  // that of a matrix inverse, and F <= 1 is computed for bodies that are apart by less than that error.
  const double least_depth = (1 - std::sqrt(contact.F)) * (a.inscribed_radius() + b.inscribed_radius());
  if (!(least_depth <= rho)) return declined;
  const PairScale scale{r.norm() + a.bounding_radius() + b.bounding_radius(), rho};
  return armijo_ascent(pair, contact.normal, scale, X_WA.position(), declined);
}

}  // namespace kernel

const char* to_string(DistanceStatus status) {
  switch (status) {
    case DistanceStatus::separated:
      return "separated";
    case DistanceStatus::overlapping:
      return "overlapping";
    case DistanceStatus::not_converged:
      return "not_converged";
    case DistanceStatus::singular:
      return "singular";
  }
  return "unknown";
}

const char* to_string(Penetration penetration) {
  switch (penetration) {
    case Penetration::global:
      return "global";
    case Penetration::local:
      return "local";
  }
  return "unknown";
}

DistanceResult distance(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  const Eigen::Vector3d r = X_WB.position() - X_WA.position();
  const double rho = a.min_curvature_radius() + b.min_curvature_radius();
  const PairScale scale{r.norm() + a.bounding_radius() + b.bounding_radius(), rho};
  const auto axis_a = a.symmetry_axis();
  const auto axis_b = b.symmetry_axis();
  DistanceResult result = axis_a && axis_b ? uniaxial_distance(a, X_WA, *axis_a, b, X_WB, *axis_b, r, scale, options)
                                           : general_distance(a, X_WA, b, X_WB, r, scale, options);
  if (result.status == DistanceStatus::not_converged) [[unlikely]] {
    result = kernel::perram_wertheim_distance(a, X_WA, b, X_WB, result.iterations);
    if (result.status == DistanceStatus::not_converged) result = deep_distance(a, X_WA, b, X_WB, r, scale, result);
  }
  return result;
}

}  // namespace geom
