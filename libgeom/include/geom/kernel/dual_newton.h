#pragma once

/// Newton's method for d = max over unit n of g(n) = n.r - hA(n) - hB(-n), r the vector from A's centre to B's.
///
/// With support points sA = grad hA(n) and sB' = -grad hB(-n), the gradient of g along the sphere is
/// y = r - sA - sB' - g n, and the Riemannian Hessian is -(M + g I) with M = P (HA + HB) P, P = I - n n^T, H the
/// Hessians of the support functions. The Newton step solves (M + g I) delta = y across n. g is 1-homogeneous and
/// concave, so M is positive semidefinite, and M + g I positive definite wherever g > 0.
///
/// With rho the smallest radius of curvature, M >= rhoA + rhoB everywhere, so that the matrix is definite for g >
/// -(rhoA + rhoB) too. Below, eigenvalues that are not positive are raised ("lifted"), which makes every step an ascent
/// direction. Positive ones are not changed: with a lifted matrix convergence is only linear, and |delta|^2 <=
/// kNormalTolerance2 would not bound the error. The step length is capped, and shortened (kBacktrack) when g falls.

#include <geom/kernel/uniaxial_pair.h>
#include <geom/shape.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace geom::kernel {

/// Values of one evaluation of g at a unit vector n.
struct Evaluation {
  double g;              ///< g(n), a length
  double decrement;      ///< y.delta >= 0: twice the increase of g that the Newton model predicts; length
  double step2;          ///< |step|^2
  Eigen::Vector3d step;  ///< Newton step delta, across n, capped to kMaxNormalStep
};

/// Evaluation whose step is of third order where that step is reliable. `decrement` and `step2` are those of the Newton
/// step contained in it.
struct ChebyshevEvaluation : Evaluation {
  double tolerance2 = kNormalTolerance2;  ///< converged after this step if step2 is no larger
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

/// Returns the fraction of Chebyshev's correction that is added to a Newton step which changes the logarithm of neither
/// support height by more than `change`: for large changes the model of third order is not reliable.
inline double chebyshev_share(double change) {
  return std::min(1.0, kChebyshevChange / change);
}

/// Replaces the Newton step of set_step by `bent`, which has that fraction of the correction added. `cubic` is
/// y.(bent - delta). The step remains Newton's if too little of y.delta is left to ensure that g grows, or if the step
/// becomes too long.
///
/// Not to be used with a lifted matrix: such a step converges linearly, whatever is added.
inline void set_bent_step(ChebyshevEvaluation& e, const Eigen::Vector3d& bent, double cubic, double change) {
  constexpr double kLongest2 = kMaxNormalStep * kMaxNormalStep;
  // One branch instead of three.
  const bool sound = static_cast<int>(e.step2 < kLongest2) & static_cast<int>(bent.squaredNorm() < kLongest2) &
                     static_cast<int>(std::abs(cubic) <= kChebyshevTrust * e.decrement);
  if (!sound) [[unlikely]]
    return;
  e.step = bent;
  e.tolerance2 = change <= kChebyshevSmallChange ? kChebyshevTolerance2 : kNormalTolerance2;
}

/// Returns `sigma`, raised if needed so that the eigenvalues sigma + t1/2 +- sqrt(t1^2/4 - D) of Newton's matrix of two
/// ellipsoids are positive.
///
/// By theory M >= rho = rhoA + rhoB, so that M + g I is definite while g > -rho; deeper overlaps need a lift. Only a
/// matrix that is not definite is lifted: with a lifted one convergence is linear.
inline double lifted(double g, double rho, double sigma, double t1, double D) {
  const double floor = kLeastEigenvalue * rho;
  if (!definite_above(floor, sigma, t1, D)) [[unlikely]] {
    const double smallest = sigma + 0.5 * t1 - std::sqrt(std::max(0.0, 0.25 * t1 * t1 - D));
    if (smallest < floor) sigma += (g > -rho ? floor : std::max(0.5 * rho, -smallest)) - smallest;
  }
  return sigma;
}

/// Returns 1 / sqrt(1 + s).
inline double inverse_sqrt_1p(double s) {
  if (std::abs(s) < kInverseSqrtSeries) return inverse_sqrt_series(s);
  return 1 / std::sqrt(1 + s);
}

/// Returns n + step on the unit sphere, for a unit n and a step across it.
///
/// The length is computed, not taken as sqrt(1 + |step|^2): a rounding error of |n| tilts the Newton step along n (y.n
/// is -2 (|n| - 1) (fA + fB + g) in the kernels), and would otherwise grow over steps and warm starts.
inline Eigen::Vector3d step_on_sphere(const Eigen::Vector3d& n, const Eigen::Vector3d& step) {
  const Eigen::Vector3d m = n + step;
  return inverse_sqrt_1p(m.squaredNorm() - 1) * m;
}

/// Returns whether a DistanceOptions::start is usable as a warm start.
inline bool is_warm(const Eigen::Vector3d& start) {
  const double start2 = start.squaredNorm();
  return start2 > kLeastStart2 && std::isfinite(start2);
}

/// Returns v / |v|, or the x axis if v is zero.
inline Eigen::Vector3d unit_or_x(const Eigen::Vector3d& v) {
  return v.squaredNorm() > 0 ? v.normalized() : Eigen::Vector3d::UnitX();
}

/// Returns v / |v| to 2 ulp, or `otherwise` if v is zero or NaN. |v|^2 must not overflow. Root and division are
/// computed in parallel, not one after the other.
inline Eigen::Vector3d unit_or(const Eigen::Vector3d& v, const Eigen::Vector3d& otherwise) {
  const double length2 = v.squaredNorm();
  if (!(length2 > 0)) [[unlikely]]
    return otherwise;
  return (std::sqrt(length2) * (1 / length2)) * v;
}

/// Orthonormal basis of the plane across a unit vector.
struct TangentBasis {
  Eigen::Vector3d e, f;

  /// Constructs the basis; e is across x, or across z if n is near x.
  explicit TangentBasis(const Eigen::Vector3d& n)
      : e((std::abs(n.x()) < 0.6 ? Eigen::Vector3d(0, n.z(), -n.y()) : Eigen::Vector3d(n.z(), 0, -n.x())).normalized()),
        f(n.cross(e)) {}
};

/// Symmetric 2 x 2 matrix in a TangentBasis.
struct TangentForm {
  double ee, ef, ff;

  /// Returns the form of H + shift I.
  static TangentForm of(const Eigen::Matrix3d& H, double shift, const TangentBasis& basis) {
    const Eigen::Vector3d He = H * basis.e;
    return {basis.e.dot(He) + shift, basis.f.dot(He), basis.f.dot(H * basis.f) + shift};
  }

  double smallest_eigenvalue() const {
    const double half_difference = 0.5 * (ee - ff);
    return 0.5 * (ee + ff) - std::sqrt(half_difference * half_difference + ef * ef);
  }
  /// Returns the unit eigenvector of the smallest eigenvalue if that is below `least`, else (or if it is NaN) zero.
  Eigen::Vector3d direction_below(double least, const TangentBasis& basis) const {
    const double lambda = smallest_eigenvalue();
    if (!(lambda < least)) return Eigen::Vector3d::Zero();
    // Either row of (form - lambda) is orthogonal to it; the longer one has more digits.
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
/// On entry `trial` is the evaluation that fell. On return it belongs to `n_trial`; if not converged, it is
/// meaningless.
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

/// Improves the unit vector n by Newton steps with backtracking until `done(e)` is true for the evaluation e at n.
///
/// `evaluate(n)` returns an Evaluation (or a struct derived from it); `rounding` is the decrease of g that counts as
/// rounding; `budget` is lowered by one for each evaluation. `e` is the evaluation at n, on entry and on return, also
/// when not converged.
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

/// Runs backtrack for climb, which has not kept the evaluation at `before`.
template <class Evaluate, class E>
[[gnu::noinline, gnu::cold]] Ascent back_from(const Evaluate& evaluate, double rounding, const Eigen::Vector3d& before,
                                              int& budget, Eigen::Vector3d& n, E& e) {
  if (budget <= 0) return Ascent::exhausted;
  const E e_before = evaluate(before);
  --budget;
  return backtrack(evaluate, rounding, before, e_before, budget, n, e);
}

/// Ascends, see ascend, until `e` has converged, from a unit vector that has not been evaluated. The kernel is called
/// at one place only, so that it is inlined into the loop and its numbers stay in registers; the way back from a step
/// that fell is in back_from.
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

/// Support height, point and Hessian in the world frame at once.
struct CurvedSupport {
  double height;
  Eigen::Vector3d point;
  Eigen::Matrix3d hessian;
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

/// Pair that ends Newton's iteration at a kink of g.
///
/// A short step along a direction of ascent raises a smooth g. At a kink, where the best normals of bodies with edges
/// and faces mostly are, g falls however short the step is, and the iteration zigzags across the kink to its limit.
template <class Pair>
class KinkWatch {
 public:
  /// Constructs the watch: `budget` is set to zero when g has fallen more than `most_falls` times.
  KinkWatch(const Pair& pair, double rounding, int most_falls, int& budget)
      : pair_(pair), rounding_(rounding), most_falls_(most_falls), budget_(budget) {}

  auto operator()(const Eigen::Vector3d& n) {
    auto e = pair_(n);
    ++evaluations_;
    if (!(e.g < g_ - rounding_)) {
      g_ = e.g;
      best_ = n;
    } else if (++falls_ > most_falls_) {
      budget_ = 0;
    }
    return e;
  }
  bool at_kink() const { return falls_ > most_falls_; }
  int evaluations() const { return evaluations_; }
  /// Returns the normal that the iteration had reached.
  const Eigen::Vector3d& best() const { return best_; }

 private:
  const Pair& pair_;
  double rounding_;
  int most_falls_;
  int& budget_;
  double g_ = -std::numeric_limits<double>::infinity();
  Eigen::Vector3d best_ = Eigen::Vector3d::UnitX();
  int falls_ = 0;
  int evaluations_ = 0;
};

}  // namespace geom::kernel
