#pragma once

/// Conversion of a converged normal of the dual Newton into a DistanceResult; used by every shape.

#include <geom/distance.h>
#include <geom/kernel/meridian_search.h>
#include <geom/kernel/simplex_descent.h>
#include <geom/kernel/sphere_search.h>
#include <geom/kernel/swept_impl.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace geom::kernel {

/// A SupportShape turned into the world frame (about its own centre).
template <SupportShape Shape>
struct WorldSupport {
  const Shape& shape;
  const Eigen::Matrix3d& R;

  Support support(const Eigen::Vector3d& n) const {
    const Support s = shape.support(R.transpose() * n);
    return {s.height, R * s.point};
  }
  CurvedSupport operator()(const Eigen::Vector3d& n) const {
    const Eigen::Vector3d n_body = R.transpose() * n;
    const Support s = shape.support(n_body);
    return {s.height, R * s.point, R * Eigen::Matrix3d(shape.support_hessian(n_body)) * R.transpose()};
  }
};

/// Lengths that the certificates and tolerances of one query need.
struct PairScale {
  double size;             ///< |r| + both bounding radii: the length that rounding errors are relative to
  double certified_depth;  ///< the sum of both smallest radii of curvature
};

template <class Shape>
double min_curvature_radius_or_zero(const Shape& shape) {
  if constexpr (requires { shape.min_curvature_radius(); }) {
    return shape.min_curvature_radius();
  } else {
    return 0;
  }
}

/// Returns the answer at a converged normal n: witness points, half of the tangential mismatch assigned to each.
template <class Pair>
[[gnu::always_inline]] inline DistanceResult witness_result(const Pair& pair, const Eigen::Vector3d& p_WA,
                                                            const Eigen::Vector3d& n, int iterations) {
  DistanceResult result;
  const SupportPair s = pair.support_pair(n);
  const Eigen::Vector3d gap = (pair.r() + s.s_b) - s.s_a;
  result.distance = (n.dot(pair.r()) - s.h_a) - s.h_b;
  const Eigen::Vector3d y = gap - n.dot(gap) * n;
  result.normal = n;
  result.point_a = p_WA + s.s_a + 0.5 * y;
  result.point_b = result.point_a + result.distance * n;
  result.residual = y.norm();
  result.iterations = iterations;
  result.status = result.distance >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  return result;
}

/// Returns a bound of the true distance minus the distance of an answer. With the ball of radius rho that rolls in the
/// Minkowski difference (sphere_search.h), g(m) <= |p + rho n| - rho everywhere, p = g n + y the point of that
/// difference at n.
inline double newton_error_bound(const PairScale& scale, const DistanceResult& r) {
  const double lambda = r.distance + scale.certified_depth;
  if (lambda > r.residual) [[likely]]
    return 0.5 * r.residual * r.residual / lambda;  // a little more than the difference below
  return std::hypot(lambda, r.residual) - lambda;
}

inline bool needs_polish(const PairScale& scale, const DistanceResult& r) {
  return r.error_bound > 0.5 * kResidualTolerance * scale.size;
}

/// Takes more Newton steps while they are needed and reduce the residual.
///
/// If the radii of curvature are much larger than the pair, for instance a thin disc beside a small body, Newton's step
/// from |delta| = 1e-6 does not yet reach rounding.
template <class Pair>
[[gnu::noinline, gnu::cold]] void polish(const Pair& pair, const PairScale& scale, const Eigen::Vector3d& p_WA,
                                         DistanceResult& result) {
  constexpr int kMostSteps = 4;
  for (int step = 0; step < kMostSteps && needs_polish(scale, result); ++step) {
    const auto e = pair(result.normal);
    DistanceResult next = witness_result(pair, p_WA, step_on_sphere(result.normal, e.step), result.iterations + 1);
    if (!(next.residual < result.residual)) return;
    result = next;
    result.error_bound = newton_error_bound(scale, result);
  }
}

/// Ascends from n by `climb_from(rounding, budget, n, e)`; returns whether `result` is an answer. Adds the evaluations
/// to `spent`.
///
/// A stationary point with g < 0 is no proof of overlap: flat bodies that are apart have some. With Penetration::local,
/// one beyond the certified depth counts only if shares(point_a, point_b), called with its witness points, confirms
/// that both bodies contain a common point.
template <class Pair, class Climb, class Shares>
[[gnu::always_inline]] inline bool answer_from(const Pair& pair, const Climb& climb_from, const PairScale& scale,
                                               const Eigen::Vector3d& p_WA, const DistanceOptions& options,
                                               const Shares& shares, Eigen::Vector3d n, int limit, int& spent,
                                               DistanceResult& result) {
  const double rounding = kRoundingFactor * scale.size;
  decltype(pair(n)) e;
  int budget = limit;
  const Ascent ascent = climb_from(rounding, budget, n, e);
  spent += limit - budget;
  if (ascent != Ascent::converged) return false;
  const bool certified = e.g >= -scale.certified_depth - rounding;
  if (!certified && options.penetration == Penetration::global) return false;
  DistanceResult found = witness_result(pair, p_WA, step_on_sphere(n, e.step), spent);
  if (!certified) {
    if (!shares(found.point_a, found.point_b)) return false;
    found.error_bound = std::numeric_limits<double>::infinity();
  } else {
    found.error_bound = newton_error_bound(scale, found);
    if (needs_polish(scale, found)) [[unlikely]] {
      polish(pair, scale, p_WA, found);
      // The step to the optimum may lead across a kink, to a support point far away.
      if (!(found.error_bound <= kWidestGap * scale.size)) return false;
    }
  }
  result = found;
  return true;
}

/// Ascends from `start`, then from cold() if that led to a stationary point without a certificate; see answer_from().
///
/// `cold` is called only when it is needed. Returns a result whose status declines when neither start gives a certified
/// answer; `iterations` is then the number of evaluations spent.
template <class Pair, class Cold, class Shares>
DistanceResult solve_dual(const Pair& pair, const Cold& cold, const PairScale& scale, const Eigen::Vector3d& p_WA,
                          const DistanceOptions& options, const Shares& shares) {
  const auto climb_from = [&pair](double rounding, int& budget, Eigen::Vector3d& n, auto& e) {
    return climb(pair, rounding, budget, n, e);
  };
  const int limit = std::max(1, options.max_iterations);
  int spent = 0;
  for (int attempt = is_warm(options.start) ? 0 : 1; attempt < 2; ++attempt) {
    const Eigen::Vector3d n = attempt == 0 ? Eigen::Vector3d(options.start / options.start.norm()) : cold();
    DistanceResult result;
    if (answer_from(pair, climb_from, scale, p_WA, options, shares, n, limit, spent, result)) return result;
  }
  DistanceResult declined;
  declined.iterations = spent;
  return declined;
}

/// Pair whose bodies have lost a skin of the thickness of their smallest radius of curvature: still convex (Blaschke).
template <class Pair>
struct CorePair {
  const Pair& pair;
  double rho_a, rho_b;

  SupportPair support_pair(const Eigen::Vector3d& n) const {
    const SupportPair s = pair.support_pair(n);
    return {s.h_a - rho_a, s.h_b - rho_b, s.s_a - rho_a * n, s.s_b + rho_b * n};
  }
  const Eigen::Vector3d& r() const { return pair.r(); }
};
template <class Pair>
CorePair(const Pair&, double, double) -> CorePair<Pair>;

/// Returns the answer of the closest points of the cores; declines where their bounds are too far apart.
template <class Pair>
DistanceResult cores_result(const CorePair<Pair>& cores, double size, const SimplexAnswer& found,
                            const Eigen::Vector3d& p_WA, int iterations) {
  DistanceResult result;
  result.iterations = iterations;
  const double bound = std::max(0.0, found.upper - found.lower);
  if (!(found.lower > 0) || !(bound < kWidestGap * size)) return result;
  result.distance = found.lower - cores.rho_a - cores.rho_b;
  result.normal = found.n;
  const Eigen::Vector3d y = found.closest.p() - found.lower * found.n;
  result.point_a = p_WA + found.closest.a + cores.rho_a * found.n + 0.5 * y;
  result.point_b = result.point_a + result.distance * found.n;
  result.residual = y.norm();
  result.error_bound = bound;
  result.status = result.distance >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  return result;
}

/// Gives bodies that overlap or touch the points that belong to the normal, where those of the support functions do
/// not: where support points jump, as on faces.
template <class Pair>
[[gnu::noinline, gnu::cold]] void take_matching_points(const Pair& pair, const PairScale& scale,
                                                       const Eigen::Vector3d& p_WA, DistanceResult& result) {
  constexpr double kLoss = 1e-13;  // of the gap, in units of the size
  const MatchingPoints found = match_points(pair, scale.size, result.normal, result.iterations);
  if (!(found.mismatch < result.residual) || !(found.gap >= result.distance - kLoss * scale.size)) return;
  result.error_bound = std::max(0.0, result.distance + result.error_bound - found.gap);
  result.distance = found.gap;
  result.normal = found.n;
  const Eigen::Vector3d y = found.at.p() - found.gap * found.n;
  result.point_a = p_WA + found.at.a + 0.5 * y;
  result.point_b = result.point_a + result.distance * result.normal;
  result.residual = found.mismatch;
  result.status = result.distance >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
}

/// Searches all normals by branch and bound (sphere_search.h), the last resort. It finds the shortest translation that
/// separates deeply overlapping bodies, and the distance of bodies for which Newton's method did not converge. `axis`:
/// see common_axis().
template <class Pair>
[[gnu::noinline, gnu::cold]] DistanceResult search_sphere(const Pair& pair, const PairScale& scale,
                                                          const Eigen::Vector3d& start, const Eigen::Vector3d& p_WA,
                                                          int iterations, const std::optional<CommonAxis>& axis) {
  const auto sample = [&](const Eigen::Vector3d& n) {
    ++iterations;
    const SupportPair s = pair.support_pair(n);
    return Tangent{n, (pair.r() + s.s_b) - s.s_a, (n.dot(pair.r()) - s.h_a) - s.h_b};
  };
  const auto done = [](const auto& e) { return converged(e); };
  const double rounding = kRoundingFactor * scale.size;
  const auto ascend_from = [&](const Eigen::Vector3d& start_n) {
    Eigen::Vector3d n = start_n;
    auto e = pair(n);
    int budget = kMaxIterations;
    (void)ascend(pair, rounding, done, budget, n, e);
    iterations += kMaxIterations - budget + 1;
    const Tangent before = sample(n);
    const Tangent after = sample(step_on_sphere(n, e.step));
    return after.g >= before.g ? after : before;
  };
  const auto upward = [&](const Eigen::Vector3d& n) { return pair.upward(n, rounding); };
  const auto polish = [&](const Eigen::Vector3d& n) {
    return climb_over_saddles(sample, ascend_from, upward, n, rounding);
  };
  double upper = std::numeric_limits<double>::infinity();
  Eigen::Vector3d first = start;
  if (axis) {
    const MeridianSearch meridian(sample, axis->u, pair.r(), scale.certified_depth, 0.5 * kDepthGap * scale.size,
                                  kFewDepthSamples);
    upper = meridian.upper() + 2 * axis->slack;
    first = meridian.best().n;
  }
  SphereSearch<decltype(sample), decltype(polish)> sphere(sample, polish, scale.certified_depth, polish(first),
                                                          rounding);
  const auto search = [&](double enough, int budget) {
    if (upper <= sphere.best().g + enough * scale.size) return;
    sphere.run_to(kDepthGap * scale.size, budget);
    upper = std::min(upper, sphere.upper());
  };
  if (axis) search(kDepthGap, kFewDepthSamples);
  search(axis ? kRingDepthGap : kDepthGap, kMostDepthSamples);
  // g is concave there, so it remains to approach its single maximum.
  if (sphere.best().g > 0) sphere.run_to(kBoundGap * scale.size, kMostDepthSamples);
  DistanceResult result = witness_result(pair, p_WA, sphere.best().n, iterations);
  result.error_bound =
      std::min(newton_error_bound(scale, result), std::max(0.0, std::min(upper, sphere.upper()) - sphere.best().g));
  if (result.residual > kWidestGap * scale.size) take_matching_points(pair, scale, p_WA, result);
  if (result.error_bound < (result.distance > 0 ? kWidestGap : kWidestDepthGap) * scale.size) return result;
  DistanceResult declined;
  declined.iterations = result.iterations;
  return declined;
}

/// Newton's method of a pair whose g may have kinks, and growing polytopes where it ends at one.
///
/// The polytopes start at the normal that Newton's method has reached: at a warm start that is nearly right, a few
/// steps close them.
template <class Pair, class Shares>
struct KinkedQuery {
  const Pair& pair;
  CorePair<Pair> cores;
  PairScale scale;
  const Eigen::Vector3d& p_WA;
  const DistanceOptions& options;
  const Shares& shares;
  DistanceResult result = {};
  int spent = 0;       ///< number of evaluations
  bool apart = false;  ///< whether a plane between the bodies has been found by their closest points

  bool answered() const { return result.status != DistanceStatus::not_converged; }

  /// Runs Newton's method from a unit vector; lowers `budget`. Returns the normal that it had reached if it ended at a
  /// kink.
  std::optional<Eigen::Vector3d> newton(const Eigen::Vector3d& start, const DistanceOptions& how, int falls,
                                        int& budget) {
    std::optional<Eigen::Vector3d> kink;
    const auto climb_from = [&](double rounding, int& left, Eigen::Vector3d& n, auto& e) {
      KinkWatch watch(pair, rounding, falls, left);
      const Ascent ascent = climb([&watch](const Eigen::Vector3d& m) { return watch(m); }, rounding, left, n, e);
      if (watch.at_kink()) kink = watch.best();
      left = budget - watch.evaluations();
      return ascent;
    };
    const int before = spent;
    answer_from(pair, climb_from, scale, p_WA, how, shares, start, budget, spent, result);
    budget -= spent - before;
    return kink;
  }

  /// Finds the closest points of bodies apart, from a unit vector: where Newton's method does not converge because
  /// support points jump. It has a second chance from their normal, and is more accurate if it converges.
  [[gnu::noinline, gnu::cold]] void descend_from(const Eigen::Vector3d& start) {
    const SimplexAnswer closest = descend(cores, start, kBoundGap * scale.size, kFine * scale.size);
    spent += closest.iterations;
    apart = closest.lower > 0;
    const DistanceResult found = cores_result(cores, scale.size, closest, p_WA, spent);
    if (found.status == DistanceStatus::not_converged) return;
    int budget = kMaxIterations;
    if (needs_polish(scale, found)) newton(found.normal, {}, kMostFalls, budget);
    if (!(result.error_bound < found.error_bound)) result = found;
  }

  /// Runs all this from the warm start, if there is one, and from `cold`.
  void solve(const Eigen::Vector3d& cold) {
    bool descended = false;
    for (int attempt = is_warm(options.start) ? 0 : 1; attempt < 2; ++attempt) {
      const Eigen::Vector3d start = attempt == 0 ? Eigen::Vector3d(options.start / options.start.norm()) : cold;
      int budget = std::max(1, options.max_iterations);
      const std::optional<Eigen::Vector3d> kink = newton(start, options, kMostFalls, budget);
      if (kink && !std::exchange(descended, true)) descend_from(*kink);
      if (answered()) return;
      // Overlapping bodies, mostly.
      if (kink) newton(*kink, options, kNoLimit, budget);
      if (answered()) return;
    }
    if (!descended || apart) descend_from(cold);
  }

  static constexpr int kNoLimit = std::numeric_limits<int>::max();
  static constexpr int kMostFalls = 4;  ///< number of times that g may fall before Newton's method gives way
  static constexpr double kFine = 0.5 * kResidualTolerance;  ///< see descend(); in units of the size
};

/// Returns the distance of any two bodies: by Newton's method, by growing polytopes, or by a search of all normals.
template <SupportShape ShapeA, SupportShape ShapeB>
DistanceResult general_distance(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                                const DistanceOptions& options) {
  const Eigen::Vector3d r = X_WB.position() - X_WA.position();
  const double rho_a = min_curvature_radius_or_zero(a);
  const double rho_b = min_curvature_radius_or_zero(b);
  const double rho = rho_a + rho_b;
  // Shapes with flat faces or edges have rho = 0; a small fraction of the inscribed radii keeps the step bounded.
  const double least =
      kLeastEigenvalue * std::max(rho, kLeastCurvature * (a.inscribed_radius() + b.inscribed_radius()));
  const GeneralPair pair(WorldSupport<ShapeA>{a, X_WA.rotation()}, WorldSupport<ShapeB>{b, X_WB.rotation()}, r, least);
  const PairScale scale{r.norm() + a.bounding_radius() + b.bounding_radius(), rho};
  const auto shares = [&](const Eigen::Vector3d& point_a, const Eigen::Vector3d& point_b) {
    return share_a_point(a, X_WA, b, X_WB, point_a, point_b);
  };
  using Query = KinkedQuery<std::remove_const_t<decltype(pair)>, decltype(shares)>;
  const Eigen::Vector3d cold = unit_or_x(r);
  Query query{pair, {pair, rho_a, rho_b}, scale, X_WA.position(), options, shares};
  query.solve(cold);
  if (query.answered()) return query.result;
  return search_sphere(pair, scale, cold, X_WA.position(), query.spent,
                       common_axis(a, X_WA.rotation(), b, X_WB.rotation()));
}

}  // namespace geom::kernel

namespace geom {

template <SupportShape ShapeA, SupportShape ShapeB>
DistanceResult distance(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                        const DistanceOptions& options) {
  if constexpr (CoreShape<ShapeA> && CoreShape<ShapeB>) {
    return kernel::core_distance(a.core(), X_WA, b.core(), X_WB, options);
  } else if constexpr (kernel::kIsRoundedBody<ShapeA>) {
    return kernel::with_skins(distance(a.inner(), X_WA, b, X_WB, options), a.radius(), 0);
  } else if constexpr (kernel::kIsRoundedBody<ShapeB>) {
    return kernel::with_skins(distance(a, X_WA, b.inner(), X_WB, options), 0, b.radius());
  } else if constexpr (kernel::kHasBall<ShapeA> && kernel::SmoothShape<ShapeB>) {
    return kernel::core_to_smooth(kernel::CoreBody(a), X_WA, b, X_WB, options);
  } else if constexpr (kernel::kHasBall<ShapeA>) {
    return kernel::core_to_body(kernel::CoreBody(a), X_WA, b, X_WB, options);
  } else if constexpr (kernel::kHasBall<ShapeB>) {
    DistanceOptions turned = options;
    turned.start = -options.start;
    return kernel::exchanged(distance(b, X_WB, a, X_WA, turned));
  } else {
    return kernel::general_distance(a, X_WA, b, X_WB, options);
  }
}

}  // namespace geom
