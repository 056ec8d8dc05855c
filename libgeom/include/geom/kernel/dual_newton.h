#pragma once

/// Newton's method for d = max over unit n of g(n) = n.r - hA(n) - hB(-n), r the vector from A's centre to B's.
///
/// With support points sA = grad hA(n) and sB' = -grad hB(-n), the gradient of g along the sphere is
/// y = r - sA - sB' - g n, and the Riemannian Hessian is -(M + g I) with M = P (HA + HB) P, H the Hessians of the
/// support functions, P = I - n n^T. The Newton step solves (M + g I) delta = y across n. g is 1-homogeneous and
/// concave, so M is positive semidefinite, and M + g I positive definite wherever g > 0.
///
/// With rho the smallest radius of curvature, M >= rhoA + rhoB everywhere, so that the matrix is definite for
/// g > -(rhoA + rhoB) too. Below, eigenvalues that are not positive are lifted, which makes every step an ascent
/// direction. Others are left alone: a lifted matrix converges linearly only, and |delta|^2 <= kNormalTolerance2 would
/// not bound the error. The step length is capped, and shortened (kBacktrack) when g falls.

#include <geom/kernel/uniaxial_pair.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace geom::kernel {

/// One evaluation of g at a unit vector n.
struct Evaluation {
  double g;              ///< length
  double decrement;      ///< y.delta >= 0: twice the increase of g that the Newton model promises; length
  double step2;          ///< |step|^2
  Eigen::Vector3d step;  ///< delta, across n, capped to kMaxNormalStep
};

/// An evaluation whose step is of third order where that can be trusted. `decrement` and `step2` are those of the
/// Newton step in it.
struct ChebyshevEvaluation : Evaluation {
  double tolerance2 = kNormalTolerance2;  ///< converged, after the step, where step2 is no larger
};

inline bool converged(const Evaluation& e) {
  return e.step2 <= kNormalTolerance2;
}
inline bool converged(const ChebyshevEvaluation& e) {
  return e.step2 <= e.tolerance2;
}

/// Sets the Newton step `delta`, |delta|^2 = `delta2`, scaled to kMaxNormalStep if it is longer.
inline void set_step(Evaluation& e, const Eigen::Vector3d& delta, double delta2) {
  e.step = delta;
  e.step2 = delta2;
  if (delta2 > kMaxNormalStep * kMaxNormalStep) {
    e.step *= kMaxNormalStep / std::sqrt(delta2);
    e.step2 = kMaxNormalStep * kMaxNormalStep;
  }
}

/// The share of Chebyshev's correction that is added to a Newton step which changes the logarithm of neither support
/// height by more than `change`: where that is much the model of third order is not to be trusted.
inline double chebyshev_share(double change) {
  return std::min(1.0, kChebyshevChange / change);
}

/// Replaces the Newton step of set_step by `bent`, which has that share of the correction added. `cubic` is
/// y.(bent - delta); where it leaves too little of y.delta for g to grow for certain, or the step becomes too long, it
/// stays Newton's.
///
/// Not for a matrix that has been lifted: such a step converges linearly, whatever is added.
inline void set_bent_step(ChebyshevEvaluation& e, const Eigen::Vector3d& bent, double cubic, double change) {
  constexpr double kLongest2 = kMaxNormalStep * kMaxNormalStep;
  // One branch, not three.
  const bool sound = static_cast<int>(e.step2 < kLongest2) & static_cast<int>(bent.squaredNorm() < kLongest2) &
                     static_cast<int>(std::abs(cubic) <= kChebyshevTrust * e.decrement);
  if (!sound) [[unlikely]]
    return;
  e.step = bent;
  e.tolerance2 = change <= kChebyshevSmallChange ? kChebyshevTolerance2 : kNormalTolerance2;
}

/// The shift `sigma` of Newton's matrix of two ellipsoids, whose eigenvalues sigma + t1/2 +- sqrt(t1^2/4 - D) should be
/// positive, raised where they are not.
///
/// By theory M >= rho = rhoA + rhoB, so that M + g I is definite while g > -rho; deeper it must be made so. Only a
/// matrix that is not definite is lifted: a lifted one converges linearly.
inline double lifted(double g, double rho, double sigma, double t1, double D) {
  const double floor = kLeastEigenvalue * rho;
  if (!definite_above(floor, sigma, t1, D)) [[unlikely]] {
    const double smallest = sigma + 0.5 * t1 - std::sqrt(std::max(0.0, 0.25 * t1 * t1 - D));
    if (smallest < floor) sigma += (g > -rho ? floor : std::max(0.5 * rho, -smallest)) - smallest;
  }
  return sigma;
}

/// 1 / sqrt(1 + s).
inline double inverse_sqrt_1p(double s) {
  if (std::abs(s) < kInverseSqrtSeries) return inverse_sqrt_series(s);
  return 1 / std::sqrt(1 + s);
}

/// n + step on the unit sphere, for a unit n and a step across it.
///
/// The length is measured, not taken as sqrt(1 + |step|^2): a rounding error of |n| tilts the Newton step along n (y.n
/// is -2 (|n| - 1) (fA + fB + g) in the kernels), and would otherwise grow over steps and warm starts.
inline Eigen::Vector3d step_on_sphere(const Eigen::Vector3d& n, const Eigen::Vector3d& step) {
  const Eigen::Vector3d m = n + step;
  return inverse_sqrt_1p(m.squaredNorm() - 1) * m;
}

/// Whether a DistanceOptions::start is one.
inline bool is_warm(const Eigen::Vector3d& start) {
  const double start2 = start.squaredNorm();
  return start2 > kLeastStart2 && std::isfinite(start2);
}

/// v / |v|, or the x axis if v is zero.
inline Eigen::Vector3d unit_or_x(const Eigen::Vector3d& v) {
  return v.squaredNorm() > 0 ? v.normalized() : Eigen::Vector3d::UnitX();
}

/// v / |v| to 2 ulp, the root beside the division and not behind it; `otherwise` if v is zero or not a number. |v|^2
/// must not overflow.
inline Eigen::Vector3d unit_or(const Eigen::Vector3d& v, const Eigen::Vector3d& otherwise) {
  const double length2 = v.squaredNorm();
  if (!(length2 > 0)) [[unlikely]]
    return otherwise;
  return (std::sqrt(length2) * (1 / length2)) * v;
}

/// An orthonormal basis across a unit vector.
struct TangentBasis {
  Eigen::Vector3d e, f;

  /// e is across x, or across z where n is near x.
  explicit TangentBasis(const Eigen::Vector3d& n)
      : e((std::abs(n.x()) < 0.6 ? Eigen::Vector3d(0, n.z(), -n.y()) : Eigen::Vector3d(n.z(), 0, -n.x())).normalized()),
        f(n.cross(e)) {}
};

/// A symmetric 2 x 2 matrix in a TangentBasis.
struct TangentForm {
  double ee, ef, ff;

  /// That of H + shift I.
  static TangentForm of(const Eigen::Matrix3d& H, double shift, const TangentBasis& basis) {
    const Eigen::Vector3d He = H * basis.e;
    return {basis.e.dot(He) + shift, basis.f.dot(He), basis.f.dot(H * basis.f) + shift};
  }

  double smallest_eigenvalue() const {
    const double half_difference = 0.5 * (ee - ff);
    return 0.5 * (ee + ff) - std::sqrt(half_difference * half_difference + ef * ef);
  }
  /// The unit eigenvector of the smallest eigenvalue, if that is below `least`; else (or if it is NaN) zero.
  Eigen::Vector3d direction_below(double least, const TangentBasis& basis) const {
    const double lambda = smallest_eigenvalue();
    if (!(lambda < least)) return Eigen::Vector3d::Zero();
    // Either row of (form - lambda) is across it; the longer one has more digits.
    const bool by_e = std::abs(ee - lambda) > std::abs(ff - lambda);
    const Eigen::Vector3d v = by_e ? Eigen::Vector3d(-ef * basis.e + (ee - lambda) * basis.f)
                                   : Eigen::Vector3d((ff - lambda) * basis.e - ef * basis.f);
    return v.squaredNorm() > 0 ? v.normalized() : basis.e;
  }
};

/// Support heights and points of A at n and of B at -n, each from its own centre. The heights are not n.s: for a thin
/// disc that product loses digits by cancellation.
struct SupportPair {
  double h_a, h_b;
  Eigen::Vector3d s_a, s_b;
};

enum class Ascent { converged, stalled, exhausted };

/// Shortens the step from n to the evaluation's improvement until g no longer falls by more than `rounding`.
///
/// On entry `trial` is the evaluation that fell; on return it belongs to `n_trial`, or to nothing if not converged.
template <class Evaluate, class E>
Ascent backtrack(const Evaluate& evaluate, double rounding, const Eigen::Vector3d& n, const E& e, int& budget,
                 Eigen::Vector3d& n_trial, E& trial) {
  double fraction = 1;
  while (trial.g < e.g - rounding) {
    if (budget <= 0) return Ascent::exhausted;
    fraction *= kBacktrack;
    if (!(fraction * fraction * e.step2 > 1e-30)) return Ascent::stalled;
    n_trial = step_on_sphere(n, fraction * e.step);
    trial = evaluate(n_trial);
    --budget;
  }
  return Ascent::converged;
}

/// Improves the unit vector n by Newton steps with backtracking until `done(e)` holds for the evaluation e at n.
///
/// `evaluate(n)` returns an Evaluation (or a struct derived from it); `rounding` is the decrease of g that counts as
/// rounding; `budget` is lowered by one for each evaluation. On entry `e` is the evaluation at n; on return it is so
/// again, also when not converged.
template <class Evaluate, class E, class Done>
Ascent ascend(const Evaluate& evaluate, double rounding, const Done& done, int& budget, Eigen::Vector3d& n, E& e) {
  while (!done(e)) {
    if (budget <= 0) return Ascent::exhausted;
    Eigen::Vector3d n_trial = step_on_sphere(n, e.step);
    E trial = evaluate(n_trial);
    --budget;
    if (trial.g < e.g - rounding) {
      const Ascent outcome = backtrack(evaluate, rounding, n, e, budget, n_trial, trial);
      if (outcome != Ascent::converged) return outcome;
    }
    n = n_trial;
    e = trial;
  }
  return Ascent::converged;
}

/// backtrack for climb, which has not kept the evaluation at `before`.
template <class Evaluate, class E>
[[gnu::noinline, gnu::cold]] Ascent back_from(const Evaluate& evaluate, double rounding, const Eigen::Vector3d& before,
                                              int& budget, Eigen::Vector3d& n, E& e) {
  if (budget <= 0) return Ascent::exhausted;
  const E e_before = evaluate(before);
  --budget;
  return backtrack(evaluate, rounding, before, e_before, budget, n, e);
}

/// As ascend, until `e` has converged, from a unit vector that has not been evaluated. There is one place that
/// evaluates, so that the kernel is inlined into the loop and its numbers stay in registers; the way back from a step
/// that fell is elsewhere.
template <class Evaluate, class E>
[[gnu::always_inline]] inline Ascent climb(const Evaluate& evaluate, double rounding, int& budget, Eigen::Vector3d& n,
                                           E& e) {
  Eigen::Vector3d before = n;
  double g_before = -std::numeric_limits<double>::infinity();
  while (true) {
    if (budget <= 0) return Ascent::exhausted;
    e = evaluate(n);
    --budget;
    if (e.g < g_before - rounding) [[unlikely]] {
      const Ascent outcome = back_from(evaluate, rounding, before, budget, n, e);
      if (outcome != Ascent::converged) return outcome;
    }
    if (converged(e)) return Ascent::converged;
    before = n;
    g_before = e.g;
    n = step_on_sphere(n, e.step);
  }
}

}  // namespace geom::kernel
