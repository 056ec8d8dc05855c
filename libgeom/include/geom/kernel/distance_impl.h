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
#include <concepts>
#include <limits>
#include <optional>
#include <utility>

namespace geom::kernel {

/// Support height, point and Hessian in the world frame at once.
struct CurvedSupport {
  double height;
  Eigen::Vector3d point;
  Eigen::Matrix3d hessian;
};

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

/// Evaluates g and its Newton step for two bodies given by their world-frame supports, with B's centre at r from A's.
template <class SupportA, class SupportB>
class GeneralPair {
 public:
  /// Constructs the pair. `least` (length) is a lower limit of Newton's matrix: smaller eigenvalues are raised to it.
  GeneralPair(SupportA a, SupportB b, const Eigen::Vector3d& r, double least)
      : a_(std::move(a)), b_(std::move(b)), r_(r), least_(least) {}

  Evaluation operator()(const Eigen::Vector3d& n) const {
    const CurvedSupport s_a = a_(n);
    const CurvedSupport s_b = b_(-n);
    Evaluation out;
    out.g = r_.dot(n) - s_a.height - s_b.height;
    const Eigen::Vector3d y = r_ - s_a.point + s_b.point - out.g * n;
    const TangentBasis basis(n);
    const auto& [e, f] = basis;
    TangentForm m = TangentForm::of(s_a.hessian + s_b.hessian, out.g, basis);
    const double smallest = m.smallest_eigenvalue();
    // Only a matrix that is not definite is raised, and no more than needed: with a raised one Newton converges
    // linearly.
    if (smallest < least_) [[unlikely]] {
      const double lift = std::max(least_, -smallest) - smallest;
      m.ee += lift;
      m.ff += lift;
    }
    const double y_e = y.dot(e);
    const double y_f = y.dot(f);
    // Beside the axis of a round face a curvature is so large that nothing but rounding is left of the difference.
    const double inv_det = 1 / std::max(m.ee * m.ff - m.ef * m.ef, 0.5 * least_ * (m.ee + m.ff));
    const double d_e = (m.ff * y_e - m.ef * y_f) * inv_det;
    const double d_f = (m.ee * y_f - m.ef * y_e) * inv_det;
    out.decrement = d_e * y_e + d_f * y_f;
    set_step(out, d_e * e + d_f * f, d_e * d_e + d_f * d_f);
    return out;
  }

  SupportPair support_pair(const Eigen::Vector3d& n) const {
    const Support a = a_.support(n);
    const Support b = b_.support(-n);
    return {a.height, b.height, a.point, b.point};
  }
  const Eigen::Vector3d& r() const { return r_; }

  /// Returns a unit vector across n along which g curves upwards by more than `rounding` / rad^2; zero if there is
  /// none.
  Eigen::Vector3d upward(const Eigen::Vector3d& n, double rounding) const {
    const CurvedSupport s_a = a_(n);
    const CurvedSupport s_b = b_(-n);
    const TangentBasis basis(n);
    const double g = r_.dot(n) - s_a.height - s_b.height;
    return TangentForm::of(s_a.hessian + s_b.hessian, g, basis).direction_below(-rounding, basis);
  }

 private:
  SupportA a_;
  SupportB b_;
  Eigen::Vector3d r_;
  double least_;
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

/// Ascends from `start`, then from cold() if that led to a stationary point without a certificate.
///
/// A stationary point with g < 0 is no proof of overlap: flat bodies that are apart have some. With Penetration::local,
/// one beyond the certified depth counts only if shares(point_a, point_b), called with its witness points, confirms
/// that both bodies contain a common point. `cold` is called only when it is needed. Returns a result whose status
/// declines when neither start gives a certified answer; `iterations` is then the number of evaluations spent.
template <class Pair, class Cold, class Shares>
DistanceResult solve_dual(const Pair& pair, const Cold& cold, const PairScale& scale, const Eigen::Vector3d& p_WA,
                          const DistanceOptions& options, const Shares& shares) {
  const double rounding = kRoundingFactor * scale.size;
  const bool warm = is_warm(options.start);
  const int limit = std::max(1, options.max_iterations);
  int spent = 0;
  for (int attempt = warm ? 0 : 1; attempt < 2; ++attempt) {
    Eigen::Vector3d n = attempt == 0 ? Eigen::Vector3d(options.start / options.start.norm()) : cold();
    decltype(pair(n)) e;
    int budget = limit;
    const Ascent ascent = climb(pair, rounding, budget, n, e);
    spent += limit - budget;
    if (ascent != Ascent::converged) continue;
    const bool certified = e.g >= -scale.certified_depth - rounding;
    if (!certified && options.penetration == Penetration::global) continue;
    DistanceResult result = witness_result(pair, p_WA, step_on_sphere(n, e.step), spent);
    if (!certified) {
      if (!shares(result.point_a, result.point_b)) continue;
      result.error_bound = std::numeric_limits<double>::infinity();
      return result;
    }
    result.error_bound = newton_error_bound(scale, result);
    if (needs_polish(scale, result)) [[unlikely]] {
      polish(pair, scale, p_WA, result);
      // The step to the optimum may lead across a kink, to a support point far away.
      if (!(result.error_bound <= kWidestGap * scale.size)) continue;
    }
    return result;
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

/// Finds the closest points of the cores; used where Newton's method does not converge because support points jump.
template <class Pair>
[[gnu::noinline, gnu::cold]] DistanceResult descend_cores(const CorePair<Pair>& cores, double size,
                                                          const Eigen::Vector3d& start, const Eigen::Vector3d& p_WA,
                                                          int iterations) {
  const SimplexAnswer found = descend(cores, start, kBoundGap * size);
  DistanceResult result;
  result.iterations = iterations + found.iterations;
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

/// Returns the distance of any two bodies: by Newton's method, by growing polytopes, or by a search of all normals.
template <SupportShape ShapeA, SupportShape ShapeB>
DistanceResult general_distance(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                                const DistanceOptions& options) {
  const Eigen::Vector3d r = X_WB.position() - X_WA.position();
  const double rho = min_curvature_radius_or_zero(a) + min_curvature_radius_or_zero(b);
  // Shapes with flat faces or edges have rho = 0; a small fraction of the inscribed radii keeps the step bounded.
  const double least =
      kLeastEigenvalue * std::max(rho, kLeastCurvature * (a.inscribed_radius() + b.inscribed_radius()));
  const GeneralPair pair(WorldSupport<ShapeA>{a, X_WA.rotation()}, WorldSupport<ShapeB>{b, X_WB.rotation()}, r, least);
  const auto cold = [&r] { return unit_or_x(r); };
  const PairScale scale{r.norm() + a.bounding_radius() + b.bounding_radius(), rho};
  const auto shares = [&](const Eigen::Vector3d& point_a, const Eigen::Vector3d& point_b) {
    return share_a_point(a, X_WA, b, X_WB, point_a, point_b);
  };
  DistanceResult result = solve_dual(pair, cold, scale, X_WA.position(), options, shares);
  if (result.status != DistanceStatus::not_converged) return result;
  const CorePair cores{pair, min_curvature_radius_or_zero(a), min_curvature_radius_or_zero(b)};
  result = descend_cores(cores, scale.size, cold(), X_WA.position(), result.iterations);
  if (result.status != DistanceStatus::not_converged) {
    if (!needs_polish(scale, result)) return result;
    // Newton's method has a second chance from there, and is more accurate if it converges.
    DistanceResult polished = solve_dual(pair, cold, scale, X_WA.position(), {.start = result.normal}, shares);
    polished.iterations += result.iterations;
    return polished.error_bound < result.error_bound ? polished : result;
  }
  return search_sphere(pair, scale, cold(), X_WA.position(), result.iterations,
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
