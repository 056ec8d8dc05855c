#pragma once

/// Basis-free dual Newton for two ellipsoids of revolution: the kernel in which a simulation spends most of its time.
///
/// A body of revolution with axis u (unit) and semi-axes a along u, b across it has Q = b^2 I + c u u^T, c = a^2 - b^2.
/// With x = n.u and w = u - x n, the support function is h^2 = b^2 |w|^2 + a^2 x^2 (the equal b^2 + c x^2 cancels for
/// discs), the support point s = (b^2 n + c x u) / h, and the Hessian across n is f I + e w w^T with f = b^2 / h, e = c
/// f / h^2. For two bodies and sigma = fA + fB + g the Newton system is a multiple of the identity plus two rank-one
/// terms, which Woodbury's formula inverts in closed form:
///
///     delta = [(sigma + t1) y - eA (wA.y) wA - eB (wB.y) wB] / [sigma (sigma + t1) + D],
///     t1 = eA |wA|^2 + eB |wB|^2,   D = eA eB (|wA|^2 |wB|^2 - (wA.wB)^2).
///
/// Its eigenvalues are sigma + t1/2 +- sqrt(t1^2/4 - D).

#include <geom/kernel/dual_newton.h>
#include <geom/kernel/uniaxial_pair.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace geom::kernel {

/// Constants of an ellipsoid of revolution with semi-axes a (along its axis) and b.
struct Spheroid {
  double a2 = 1;   ///< a^2
  double b2 = 1;   ///< b^2
  double c = 0;    ///< a^2 - b^2, computed as (a - b)(a + b)
  double rho = 1;  ///< smallest radius of curvature, min(a, b)^2 / max(a, b)
  /// |c| / min(a, b): d2h/dt2 <= turning_limit * Omega^2 at fixed n while u rotates at Omega.
  double turning_limit = 0;

  Spheroid() = default;
  Spheroid(double a, double b) : Spheroid(a, b, std::min(a, b) * (std::min(a, b) / std::max(a, b))) {}
  Spheroid(double a, double b, double min_curvature_radius)
      : a2(a * a),
        b2(b * b),
        c((a - b) * (a + b)),
        rho(min_curvature_radius),
        turning_limit(std::abs(c) / std::min(a, b)) {}
};

/// Pair of numbers, one of A and one of B: both bodies go through the same operations, two to an SSE2 register.
using Both = Eigen::Array2d;

using UniaxialSample = UniaxialSampleOf<Both>;

/// Evaluation with the values that the time derivative of g needs.
struct UniaxialEvaluation : Evaluation {
  Both x;
  Both lever;
};

/// Returns g at the unit vector n, for A at the origin and B at r.
[[gnu::always_inline]] inline UniaxialSample uniaxial_gap(const Spheroid& A, const Spheroid& B,
                                                          const Eigen::Vector3d& r, const Eigen::Vector3d& u_a,
                                                          const Eigen::Vector3d& u_b, const Eigen::Vector3d& n) {
  return uniaxial_gap_of<Both>(A, B, r, u_a, u_b, n);
}

/// Completes an evaluation: computes the Newton step of n.
[[gnu::always_inline]] inline UniaxialEvaluation uniaxial_step(const Spheroid& A, const Spheroid& B,
                                                               const Eigen::Vector3d& r, const Eigen::Vector3d& u_a,
                                                               const Eigen::Vector3d& u_b, const Eigen::Vector3d& n,
                                                               const UniaxialSample& gap) {
  const auto lift = [&](double sigma, double t1, double D) { return lifted(gap.g, A.rho + B.rho, sigma, t1, D); };
  const auto newton = uniaxial_step_of(A, B, r, u_a, u_b, n, gap, lift);
  UniaxialEvaluation out;
  out.g = gap.g;
  out.decrement = newton.decrement;
  set_step(out, newton.delta, newton.delta2);
  out.x = gap.x;
  out.lever = gap.lever;
  return out;
}

/// Returns g and its Newton step at the unit vector n.
[[gnu::always_inline]] inline UniaxialEvaluation evaluate_uniaxial(const Spheroid& A, const Spheroid& B,
                                                                   const Eigen::Vector3d& r, const Eigen::Vector3d& u_a,
                                                                   const Eigen::Vector3d& u_b,
                                                                   const Eigen::Vector3d& n) {
  return uniaxial_step(A, B, r, u_a, u_b, n, uniaxial_gap(A, B, r, u_a, u_b, n));
}

/// Returns the support point of one body at the unit vector n, from its centre.
inline Eigen::Vector3d support_point(const Spheroid& S, const Eigen::Vector3d& u, const Eigen::Vector3d& n) {
  const double x = u.dot(n);
  const double h = std::sqrt(S.b2 * (u - x * n).squaredNorm() + S.a2 * (x * x));
  return (S.b2 * n + (S.c * x) * u) / h;
}

/// Returns the unit vector of cold_direction; u_a if the centres coincide (n is then arbitrary).
inline Eigen::Vector3d cold_normal(const Spheroid& A, const Spheroid& B, const Eigen::Vector3d& r,
                                   const Eigen::Vector3d& u_a, const Eigen::Vector3d& u_b) {
  const Eigen::Vector3d n = cold_direction(A, B, r, u_a, u_b);
  const double length2 = n.squaredNorm();
  return length2 > 0 ? Eigen::Vector3d((1 / std::sqrt(length2)) * n) : u_a;
}

}  // namespace geom::kernel
