#pragma once

/// Basis-free dual Newton for two ellipsoids of revolution: the kernel that the simulator's time is spent in.
///
/// A body of revolution with axis u (unit) and semi-axes a along u, b across it has Q = b^2 I + c u u^T, c = a^2 - b^2.
/// With x = n.u and w = u - x n, the support function is h^2 = b^2 |w|^2 + a^2 x^2 (the equal b^2 + c x^2 cancels for
/// discs), the support point s = (b^2 n + c x u) / h, and the Hessian across n is f I + e w w^T with f = b^2 / h,
/// e = c f / h^2. For two bodies and sigma = fA + fB + g the Newton system is a multiple of the identity plus two
/// rank-one terms, which Woodbury's formula inverts in closed form:
///
///     delta = [(sigma + t1) y - eA (wA.y) wA - eB (wB.y) wB] / [sigma (sigma + t1) + D],
///     t1 = eA |wA|^2 + eB |wB|^2,   D = eA eB (|wA|^2 |wB|^2 - (wA.wB)^2).
///
/// Its eigenvalues are sigma + t1/2 +- sqrt(t1^2/4 - D).

#include <geom/internal/dual_newton.h>
#include <geom/internal/uniaxial_pair.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace geom::internal {

/// What the kernel needs of an ellipsoid of revolution with semi-axes a (along its axis) and b.
struct Spheroid {
  double a2 = 1;             ///< a^2
  double b2 = 1;             ///< b^2
  double c = 0;              ///< a^2 - b^2, computed as (a - b)(a + b)
  double rho = 1;            ///< smallest radius of curvature, min(a, b)^2 / max(a, b)
  double turning_limit = 0;  ///< |c| / min(a, b): d2h/dt2 <= turning_limit * Omega^2 at fixed n while u turns at Omega

  Spheroid() = default;
  Spheroid(double a, double b) : Spheroid(a, b, std::min(a, b) * (std::min(a, b) / std::max(a, b))) {}
  Spheroid(double a, double b, double min_curvature_radius)
      : a2(a * a),
        b2(b * b),
        c((a - b) * (a + b)),
        rho(min_curvature_radius),
        turning_limit(std::abs(c) / std::min(a, b)) {}
};

/// One number of A and one of B: both bodies go through the same operations, two to an SSE2 register.
using Both = Eigen::Array2d;

using UniaxialGap = UniaxialGapOf<Both>;

/// An evaluation that also carries what the time derivative of g needs.
struct UniaxialEvaluation : Evaluation {
  Both x;
  Both lever;
};

/// g at the unit vector n, for A at the origin and B at r.
[[gnu::always_inline]] inline UniaxialGap uniaxial_gap(const Spheroid& A, const Spheroid& B, const Eigen::Vector3d& r,
                                                       const Eigen::Vector3d& u_a, const Eigen::Vector3d& u_b,
                                                       const Eigen::Vector3d& n) {
  return uniaxial_gap_of<Both>(A, B, r, u_a, u_b, n);
}

/// The second half: the Newton step of n.
[[gnu::always_inline]] inline UniaxialEvaluation uniaxial_step(const Spheroid& A, const Spheroid& B,
                                                               const Eigen::Vector3d& r, const Eigen::Vector3d& u_a,
                                                               const Eigen::Vector3d& u_b, const Eigen::Vector3d& n,
                                                               const UniaxialGap& gap) {
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

/// g and its Newton step at the unit vector n.
[[gnu::always_inline]] inline UniaxialEvaluation evaluate_uniaxial(const Spheroid& A, const Spheroid& B,
                                                                   const Eigen::Vector3d& r, const Eigen::Vector3d& u_a,
                                                                   const Eigen::Vector3d& u_b,
                                                                   const Eigen::Vector3d& n) {
  return uniaxial_step(A, B, r, u_a, u_b, n, uniaxial_gap(A, B, r, u_a, u_b, n));
}

/// s(n) = (b^2 w' + a^2 x u) / h with w' = n - x u (without the cancellation of b^2 n + c x u for discs), A and B at
/// once; unit n.
[[gnu::always_inline]] inline SupportPair support_pair(const Spheroid& A, const Spheroid& B, const Eigen::Vector3d& u_a,
                                                       const Eigen::Vector3d& u_b, const Eigen::Vector3d& n) {
  const Both ux(u_a.x(), u_b.x()), uy(u_a.y(), u_b.y()), uz(u_a.z(), u_b.z());
  const Both b2(A.b2, B.b2), a2(A.a2, B.a2);
  const Both x = ux * n.x() + uy * n.y() + uz * n.z();
  const Both wx = n.x() - x * ux, wy = n.y() - x * uy, wz = n.z() - x * uz;
  const Both h = (b2 * (wx * wx + wy * wy + wz * wz) + a2 * (x * x)).sqrt();
  const Both signed_inv_h = Both(1, -1) / h;  // s(-n) = -s(n)
  const Both across = b2 * signed_inv_h;
  const Both along = (a2 * x) * signed_inv_h;
  const Both sx = across * wx + along * ux;
  const Both sy = across * wy + along * uy;
  const Both sz = across * wz + along * uz;
  return {h[0], h[1], {sx[0], sy[0], sz[0]}, {sx[1], sy[1], sz[1]}};
}

/// Support point of one body at the unit vector n, from its centre.
inline Eigen::Vector3d support_point(const Spheroid& S, const Eigen::Vector3d& u, const Eigen::Vector3d& n) {
  const double x = u.dot(n);
  const double h = std::sqrt(S.b2 * (u - x * n).squaredNorm() + S.a2 * (x * x));
  return (S.b2 * n + (S.c * x) * u) / h;
}

/// The unit vector of cold_direction; for centres that coincide u_a (n is then any direction).
inline Eigen::Vector3d cold_normal(const Spheroid& A, const Spheroid& B, const Eigen::Vector3d& r,
                                   const Eigen::Vector3d& u_a, const Eigen::Vector3d& u_b) {
  const Eigen::Vector3d n = cold_direction(A, B, r, u_a, u_b);
  const double length2 = n.squaredNorm();
  return length2 > 0 ? Eigen::Vector3d((1 / std::sqrt(length2)) * n) : u_a;
}

/// Where a query without a start begins: (QA / hA + QB / hB + g I)^-1 r on the unit sphere, with hA, hB and g, if that
/// is positive, those of the line of centres; r is g n + QA n / hA + QB n / hB at the answer. For centres that coincide
/// u_a.
///
/// Between bodies apart by their size that is one evaluation nearer to the answer than cold_normal, which is made for
/// bodies that touch, and between those never further from it.
inline Eigen::Vector3d start_normal(const Spheroid& A, const Spheroid& B, const Eigen::Vector3d& r,
                                    const Eigen::Vector3d& u_a, const Eigen::Vector3d& u_b) {
  // All for n = r, of any length: numbers of the line of centres are divided by |r|.
  const double r2 = r.squaredNorm();
  const Both along(r.dot(u_a), r.dot(u_b));
  const Both c(A.c, B.c), b2(A.b2, B.b2);
  const Both h2 = b2 * r2 + c * (along * along);
  const Both h = h2.sqrt();
  const Both inv_h = h * (1 / h2);  // beside the square root, not behind it
  const double g = std::max(0.0, (r2 - h[0]) - h[1]) / r2;
  const Both p = c * inv_h;
  // sigma I + pA uA uA^T + pB uB uB^T, inverted by Woodbury's formula as in cold_direction.
  const double sigma = (b2 * inv_h).sum() + g;
  const double k = u_a.dot(u_b);
  const double of_a = sigma + p[0], of_b = sigma + p[1];
  const double det = of_a * of_b - (p[0] * p[1]) * (k * k);
  const double x_a = of_b * along[0] - (p[1] * k) * along[1];
  const double x_b = of_a * along[1] - (p[0] * k) * along[0];
  const Eigen::Vector3d n = det * r - (p[0] * x_a) * u_a - (p[1] * x_b) * u_b;
  const double length2 = n.squaredNorm();
  return length2 > 0 ? Eigen::Vector3d((1 / std::sqrt(length2)) * n) : u_a;
}

}  // namespace geom::internal
