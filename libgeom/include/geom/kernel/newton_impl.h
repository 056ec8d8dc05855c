#pragma once

/// Newton's method for the paper's eqs. (dist8), and the check that its solution is the answer.
///
/// All quantities are first made dimensionless: lengths by L = |r| + |xA| + |xB| of the seed, f and g by the lengths of
/// their gradients there. That multiplies equations and unknowns by constants, which changes no iterate of Newton's
/// method, but makes alpha and all equations of order one, so that a single number measures the residual, pivots are
/// meaningful and nothing overflows. xA and xB are relative to their own centres (here sA, sB): far pairs lose no
/// digits.

#include <geom/kernel/newton_equations.h>
#include <geom/kernel/refuse.h>
#include <geom/kernel/small_solve.h>
#include <geom/newton.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

namespace geom::kernel {

/// Scales and positions of one query, which convert its dimensionless solution into a DistanceResult.
struct NewtonFrame {
  Eigen::Vector3d r;  ///< vector from A's centre to B's, over `length`
  Eigen::Vector3d p_WA;
  double length;
  double certified_depth;  ///< the sum of both smallest radii of curvature
};

/// Returns g(n) of distance.h, dimensionless: a lower bound of the distance. NaN for shapes without a support function.
template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
double certain_gap(const WorldSurface<ShapeA>& a, const WorldSurface<ShapeB>& b, const NewtonFrame& frame,
                   const Eigen::Vector3d& n) {
  if constexpr (SupportShape<ShapeA> && SupportShape<ShapeB>) {
    const double h_a = Support(a.shape.support(a.R.transpose() * n)).height;
    const double h_b = Support(b.shape.support(b.R.transpose() * -n)).height;
    return n.dot(frame.r) - (h_a + h_b) / frame.length;
  } else {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

/// Judgement of a solution of eqs. (dist8).
enum class Verdict {
  answer,
  too_deep,   ///< a solution, but not necessarily the answer
  imprecise,  ///< the equations are not fulfilled accurately enough
};

struct JudgedResult {
  DistanceResult result;  ///< declined unless `verdict` is `answer`
  Verdict verdict = Verdict::imprecise;
};

/// Returns the answer at a solution of eqs. (dist8), or a declined one if the solution is not the answer or not
/// accurate enough.
///
/// A last step of eqs. (dist8b) and (dist8c) alone, -f f_x / |f_x|^2, moves the points onto their surfaces to second
/// order. With theta the angle between the normals and y the part of xB - xA across them, the error of the distance of
/// the tangent planes, n.(xB - xA), is then at most |y|^2 / (2 d) (or |y|) upwards and theta^2 / 2 radii of curvature
/// downwards.
///
/// Radii of curvature are unbounded on flat faces. Bodies that have a support function also have the lower bound g(n),
/// which is used instead. At a sharp edge the normal of f changes with the last digit of the point; there n is the
/// direction of xB - xA, for which g(n) certifies the distance whatever the normals.
template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
JudgedResult judge_solution(const WorldSurface<ShapeA>& a, const WorldSurface<ShapeB>& b, const LocalSurface& f,
                            const LocalSurface& g, const NewtonState& solution, const NewtonFrame& frame) {
  JudgedResult judged;
  const double norm_f = f.gradient.norm();
  const double norm_g = g.gradient.norm();
  Eigen::Vector3d n = f.gradient / norm_f;
  const Eigen::Vector3d m = g.gradient / norm_g;
  const double offset_a = f.value / norm_f;
  const double offset_b = g.value / norm_g;
  // Size of the solution: `length` is that of the seed, whose points may lie anywhere.
  const double size = std::min(1.0, frame.r.norm() + solution.s_a.norm() + solution.s_b.norm());
  const double tolerance = kNewtonResidual * size;
  if (!(std::abs(offset_a) <= tolerance && std::abs(offset_b) <= tolerance)) return judged;
  const Eigen::Vector3d s_a = solution.s_a - offset_a * n;
  const Eigen::Vector3d gap = frame.r + (solution.s_b - offset_b * m) - s_a;
  const bool antiparallel = (n + m).norm() <= kNewtonAngle;
  double d = n.dot(gap);
  if (!antiparallel) {
    const double length = gap.norm();
    if (!(d > 0 && certain_gap(a, b, frame, gap / length) > 0)) return judged;
    n = gap / length;
    d = length;
  }
  const Eigen::Vector3d y = gap - d * n;
  const double mismatch = y.norm();
  double error = d > mismatch ? 0.5 * mismatch * (mismatch / d) : mismatch;
  if constexpr (SupportShape<ShapeA> && SupportShape<ShapeB>) {
    const double lowest = certain_gap(a, b, frame, n);
    error += std::max(0.0, d - lowest);
    d = lowest;
  }
  if (!(error <= tolerance)) return judged;
  judged.verdict = Verdict::too_deep;
  if (!(d * frame.length >= -frame.certified_depth - kRoundingFactor * size * frame.length)) return judged;
  judged.verdict = Verdict::answer;
  DistanceResult& result = judged.result;
  result.distance = d * frame.length;
  result.normal = n;
  result.point_a = frame.p_WA + frame.length * (s_a + 0.5 * y);
  result.point_b = result.point_a + result.distance * n;
  result.residual = mismatch * frame.length;
  result.error_bound = error * frame.length;
  result.status = d >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  return judged;
}

/// Shortening of steps in addition to kMaxNewtonLength.
enum class Damping {
  none,
  residual,  ///< halved until |F| falls, up to kMaxNewtonHalvings times
};

/// Makes one attempt of Newton's method from `start`.
template <class Equations, ImplicitSurface ShapeA, ImplicitSurface ShapeB>
DistanceResult attempt_newton(const WorldSurface<ShapeA>& a, const WorldSurface<ShapeB>& b, const NewtonState& start,
                              const NewtonFrame& frame, int max_iterations, Damping damping) {
  DistanceResult declined;
  double previous_length = std::numeric_limits<double>::infinity();
  auto point = newton_point<Equations>(a, b, frame.r, start);
  int iterations = 1;
  while (iterations < max_iterations) {
    typename Equations::Vector step =
        -solve_small<Equations::kSize>(Equations::jacobian(point.f, point.g, point.y), point.F);
    double length = Equations::length(step);
    if (!std::isfinite(length)) {
      declined.status = DistanceStatus::singular;
      break;
    }
    if (length > kMaxNewtonLength) step *= kMaxNewtonLength / length;
    auto next = newton_point<Equations>(a, b, frame.r, Equations::moved(point.y, step));
    ++iterations;
    if (damping == Damping::residual) {
      const double residual2 = point.F.squaredNorm();
      for (int k = 0; k < kMaxNewtonHalvings && !(next.F.squaredNorm() < residual2); ++k) {
        step *= 0.5;
        length *= 0.5;
        next = newton_point<Equations>(a, b, frame.r, Equations::moved(point.y, step));
        ++iterations;
      }
    }
    point = next;
    // Convergence is quadratic until the steps are rounding, which is when they stop shrinking. On a flat face they
    // stay long (a move along it changes nothing), and the criterion is that the equations are fulfilled.
    const bool rounding = length <= kNewtonStall && length > 0.5 * previous_length;
    if (length <= kNewtonStep || rounding || point.F.cwiseAbs().maxCoeff() <= kNewtonResidual) {
      JudgedResult judged = judge_solution(a, b, point.f, point.g, point.y, frame);
      judged.result.iterations = iterations;
      if (judged.verdict != Verdict::imprecise) return judged.result;
    }
    previous_length = length;
  }
  declined.iterations = iterations;
  return declined;
}

/// Runs Newton's method from `start`, twice if necessary.
///
/// In the first attempt steps are only shortened to kMaxNewtonLength. For 1000 ellipsoids with X0 = 10, from the points
/// on the line of centres, that raised the fraction of pairs that are solved from 56 % to 99 % (eight equations) and
/// from 41 % to 91 % (five), while shortening steps until |F| falls lowered it: on the way from a bad guess |F| has to
/// grow.
///
/// Across an edge of a superellipsoid the normal changes by a right angle within a tiny distance, and steps overshoot
/// again and again. Requiring |F| to fall prevents that: from libccd's points, for pairs with exponents 1.6 the first
/// attempt solves 40 %, the second nearly all of the rest.
template <class Equations, ImplicitSurface ShapeA, ImplicitSurface ShapeB>
DistanceResult solve_newton(const WorldSurface<ShapeA>& a, const WorldSurface<ShapeB>& b, const NewtonState& start,
                            const NewtonFrame& frame, int max_iterations) {
  DistanceResult first = attempt_newton<Equations>(a, b, start, frame, max_iterations, Damping::none);
  const bool ended = first.status == DistanceStatus::not_converged && first.iterations < max_iterations;
  if (!std::isnan(first.distance) || ended) return first;
  DistanceResult second = attempt_newton<Equations>(a, b, start, frame, max_iterations, Damping::residual);
  second.iterations += first.iterations;
  return second;
}

template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
DistanceResult newton_distance_unchecked(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                                         NewtonSystem system, const WitnessPair& seed, const NewtonOptions& options) {
  DistanceResult declined;
  if (seed.status != SeedStatus::usable) return declined;
  NewtonFrame frame;
  frame.r = X_WB.position() - X_WA.position();
  frame.p_WA = X_WA.position();
  frame.certified_depth = min_curvature_radius_or_zero(a) + min_curvature_radius_or_zero(b);
  NewtonState start{seed.point_a - X_WA.position(), seed.point_b - X_WB.position(), 1, 0};
  frame.length = frame.r.norm() + start.s_a.norm() + start.s_b.norm();
  frame.r /= frame.length;
  start.s_a /= frame.length;
  start.s_b /= frame.length;
  WorldSurface<ShapeA> surface_a{a, X_WA.rotation(), frame.length};
  WorldSurface<ShapeB> surface_b{b, X_WB.rotation(), frame.length};
  const Eigen::Vector3d gradient_a = surface_a(start.s_a).gradient;
  surface_a.unit = gradient_a.norm();
  surface_b.unit = surface_b(start.s_b).gradient.norm();
  if (!(surface_a.unit > 0 && surface_b.unit > 0)) {  // vanishing gradients, or a seed that is not finite
    declined.status = DistanceStatus::singular;
    return declined;
  }
  // alpha^2 = |f_x| / |g_x| is 1 in these units; beta from eq. (dist8d) along f_x, which is a unit vector here.
  start.beta = gradient_a.dot(frame.r + start.s_b - start.s_a) / surface_a.unit;
  return system == NewtonSystem::eight
             ? solve_newton<EightEquations>(surface_a, surface_b, start, frame, options.max_iterations)
             : solve_newton<FiveEquations>(surface_a, surface_b, start, frame, options.max_iterations);
}

/// Refuses a seed's point; `name` is the member of WitnessPair, `reason` states what is wrong and what is accepted.
[[noreturn]] inline void refuse_seed(const char* name, const Eigen::Vector3d& point, const std::string& reason) {
  std::ostringstream message;
  message << "newton_distance: " << name << " of the seed, (" << point.x() << ", " << point.y() << ", " << point.z()
          << "), " << reason;
  refuse(message.str());
}

/// Returns the smallest f that check_seed accepts at a point x, in the body's frame.
template <ImplicitSurface Shape>
double least_seed_value(const Shape& shape, const Eigen::Vector3d& x) {
  return -kMaxSeedDepth * Eigen::Vector3d(shape.gradient(x)).norm() * x.norm();
}

/// Throws unless `point` (world frame) is finite and at most kMaxSeedDepth inside the body.
template <ImplicitSurface Shape>
void check_seed_point(const char* name, const Shape& shape, const Pose& X, const Eigen::Vector3d& point) {
  if (!point.allFinite()) refuse_seed(name, point, "is not finite; accepted: three finite numbers");
  const Eigen::Vector3d x = X.to_body(point);
  const double f = shape.value(x);
  const double least = least_seed_value(shape, x);
  if (f >= least) return;
  std::ostringstream reason;
  reason << "lies inside its body: f = " << f << "; accepted: on the surface, outside, or inside by at most "
         << kMaxSeedDepth << " of its distance from the body's centre, f >= " << least;
  refuse_seed(name, point, reason.str());
}

/// Returns the t > 0 where the ray t u from the centre leaves the body, to 1e-9 relative; NaN if the centre is not
/// inside.
template <ImplicitSurface Shape>
double ray_exit(const Shape& shape, const Eigen::Vector3d& u, double guess) {
  if (!(shape.value(Eigen::Vector3d::Zero()) < 0)) return std::numeric_limits<double>::quiet_NaN();
  double low = 0;
  double high = guess;
  while (shape.value(high * u) < 0) {
    low = high;
    high *= 2;
    if (!std::isfinite(high)) return std::numeric_limits<double>::quiet_NaN();
  }
  // Newton's method, with bisection if it leaves the bracket.
  double t = high;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const double f = shape.value(t * u);
    (f < 0 ? low : high) = t;
    double next = t - f / Eigen::Vector3d(shape.gradient(t * u)).dot(u);
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (std::abs(next - t) <= 1e-9 * t) return next;
    t = next;
  }
  return t;
}

}  // namespace geom::kernel

namespace geom {

template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
DistanceResult newton_distance(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                               NewtonSystem system, const WitnessPair& seed, const NewtonOptions& options) {
  check_seed(a, X_WA, b, X_WB, seed);
  return kernel::newton_distance_unchecked(a, X_WA, b, X_WB, system, seed, options);
}

template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
void check_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const WitnessPair& seed) {
  if (seed.status != SeedStatus::usable) return;
  kernel::check_seed_point("point_a", a, X_WA, seed.point_a);
  kernel::check_seed_point("point_b", b, X_WB, seed.point_b);
}

template <ImplicitSurface ShapeA, ImplicitSurface ShapeB>
WitnessPair centre_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB) {
  const Eigen::Vector3d r = X_WB.position() - X_WA.position();
  const double length = r.norm();
  if (!(length > 0)) return {};
  const Eigen::Vector3d u = r / length;
  const double t_a = kernel::ray_exit(a, X_WA.rotation().transpose() * u, length);
  const double t_b = kernel::ray_exit(b, X_WB.rotation().transpose() * -u, length);
  if (!std::isfinite(t_a) || !std::isfinite(t_b)) return {};
  return {X_WA.position() + t_a * u, X_WB.position() - t_b * u, SeedStatus::usable};
}

template <SupportShape ShapeA, SupportShape ShapeB>
WitnessPair normal_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                        const Eigen::Vector3d& n) {
  const Eigen::Vector3d u = n.stableNormalized();
  if (!n.allFinite() || !(u.squaredNorm() > 0.5)) return {};
  const Support s_a = a.support(X_WA.rotation().transpose() * u);
  const Support s_b = b.support(X_WB.rotation().transpose() * -u);
  return {X_WA.to_world(s_a.point), X_WB.to_world(s_b.point), SeedStatus::usable};
}

template <SupportShape ShapeA, SupportShape ShapeB>
WitnessPair dual_seed(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB) {
  const DistanceResult r = distance(a, X_WA, b, X_WB);
  const bool answered = r.status == DistanceStatus::separated || r.status == DistanceStatus::overlapping;
  if (!answered) return {};
  return {r.point_a, r.point_b, SeedStatus::usable};
}

}  // namespace geom
