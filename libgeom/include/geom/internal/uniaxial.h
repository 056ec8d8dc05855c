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

/// The first half of an evaluation: g, what its time derivative needs, and what the second half goes on with.
struct UniaxialGap {
  double g;           ///< n.r - hA(n) - hB(-n)
  double lever_a;     ///< c x / h of A: dhA/dt = lever_a * (n.duA/dt) at fixed n
  double lever_b;     ///< the same of B
  double x_a, x_b;    ///< n.uA, n.uB
  double z;           ///< n.r
  double w2_a, w2_b;  ///< |w|^2, w = u - x n
  double inv_h_a, inv_h_b;
  double inv_h2_a, inv_h2_b;
};

/// An evaluation that also carries what the time derivative of g needs.
struct UniaxialEvaluation : Evaluation {
  double x_a, x_b;
  double lever_a, lever_b;
};

/// g at the unit vector n, for A at the origin and B at r.
inline UniaxialGap uniaxial_gap(const Spheroid& A, const Spheroid& B, const Eigen::Vector3d& r,
                                const Eigen::Vector3d& u_a, const Eigen::Vector3d& u_b, const Eigen::Vector3d& n) {
  // Here and below the order of the operations keeps the dependency chain short: it is what the time goes into.
  UniaxialGap out;
  out.x_a = u_a.dot(n);
  out.x_b = u_b.dot(n);
  out.z = r.dot(n);
  out.w2_a = (u_a - out.x_a * n).squaredNorm();
  out.w2_b = (u_b - out.x_b * n).squaredNorm();
  const double h2_a = A.b2 * out.w2_a + A.a2 * (out.x_a * out.x_a);
  const double h2_b = B.b2 * out.w2_b + B.a2 * (out.x_b * out.x_b);
  const double h_a = std::sqrt(h2_a);
  const double h_b = std::sqrt(h2_b);
  out.inv_h2_a = 1 / h2_a;  // beside the square root, not behind it
  out.inv_h2_b = 1 / h2_b;
  out.inv_h_a = h_a * out.inv_h2_a;
  out.inv_h_b = h_b * out.inv_h2_b;
  out.g = (out.z - h_a) - h_b;
  out.lever_a = (A.c * out.x_a) * out.inv_h_a;
  out.lever_b = (B.c * out.x_b) * out.inv_h_b;
  return out;
}

/// The second half: the Newton step of n.
inline UniaxialEvaluation uniaxial_step(const Spheroid& A, const Spheroid& B, const Eigen::Vector3d& r,
                                        const Eigen::Vector3d& u_a, const Eigen::Vector3d& u_b,
                                        const Eigen::Vector3d& n, const UniaxialGap& gap) {
  const Eigen::Vector3d w_a = u_a - gap.x_a * n;
  const Eigen::Vector3d w_b = u_b - gap.x_b * n;
  const Eigen::Vector3d y = (r - gap.z * n) - (gap.lever_a * w_a + gap.lever_b * w_b);
  const double f_a = A.b2 * gap.inv_h_a;
  const double f_b = B.b2 * gap.inv_h_b;
  const double e_a = (A.c * gap.inv_h2_a) * f_a;
  const double e_b = (B.c * gap.inv_h2_b) * f_b;
  const double ww = w_a.dot(w_b);
  const double t1 = e_a * gap.w2_a + e_b * gap.w2_b;
  const double D = (e_a * e_b) * (gap.w2_a * gap.w2_b - ww * ww);
  double sigma = (f_a + f_b) + gap.g;
  // Both eigenvalues are at least `floor` if and only if the quadratic q^2 + q t1 + D and q + t1/2 are non-negative at
  // q = sigma - floor; the square root is needed only when they are not.
  // By theory M >= rho = rhoA + rhoB, so that M + g I is definite while g > -rho; deeper it must be made so.
  const double rho = A.rho + B.rho;
  const double floor = gap.g > -rho ? kLeastEigenvalue * rho : 0.5 * rho;
  const double q = sigma - floor;
  if (!(q * (q + t1) + D >= 0 && q + 0.5 * t1 >= 0)) [[unlikely]] {
    const double smallest = sigma + 0.5 * t1 - std::sqrt(std::max(0.0, 0.25 * t1 * t1 - D));
    if (smallest < floor) sigma += floor - smallest;
  }
  const double inv_det = 1 / (sigma * (sigma + t1) + D);
  const double y_a = e_a * w_a.dot(y);
  const double y_b = e_b * w_b.dot(y);
  const Eigen::Vector3d adjugate_y = (sigma + t1) * y - (y_a * w_a + y_b * w_b);
  UniaxialEvaluation out;
  out.g = gap.g;
  out.decrement = inv_det * y.dot(adjugate_y);
  set_step(out, inv_det * adjugate_y, (inv_det * inv_det) * adjugate_y.squaredNorm());
  out.x_a = gap.x_a;
  out.x_b = gap.x_b;
  out.lever_a = gap.lever_a;
  out.lever_b = gap.lever_b;
  return out;
}

/// g and its Newton step at the unit vector n.
inline UniaxialEvaluation evaluate_uniaxial(const Spheroid& A, const Spheroid& B, const Eigen::Vector3d& r,
                                            const Eigen::Vector3d& u_a, const Eigen::Vector3d& u_b,
                                            const Eigen::Vector3d& n) {
  return uniaxial_step(A, B, r, u_a, u_b, n, uniaxial_gap(A, B, r, u_a, u_b, n));
}

/// Support point s(n) = (b^2 n + c x u) / h, unit n.
inline Eigen::Vector3d support_point(const Spheroid& S, const Eigen::Vector3d& u, const Eigen::Vector3d& n) {
  const double x = u.dot(n);
  const double h = std::sqrt(S.b2 * (u - x * n).squaredNorm() + S.a2 * (x * x));
  return (S.b2 * n + (S.c * x) * u) / h;
}

/// Cold start: n along (QA + QB)^-1 r, by Woodbury's formula. Exact for spheres and for parallel coaxial bodies.
/// Centres that coincide give u_a (n is then any direction).
inline Eigen::Vector3d cold_normal(const Spheroid& A, const Spheroid& B, const Eigen::Vector3d& r,
                                   const Eigen::Vector3d& u_a, const Eigen::Vector3d& u_b) {
  const double inv = 1 / (A.b2 + B.b2);
  const double p = A.c * inv;
  const double q = B.c * inv;
  const double k = u_a.dot(u_b);
  const double r_a = r.dot(u_a);
  const double r_b = r.dot(u_b);
  const double inv_det = 1 / ((1 + p) * (1 + q) - p * q * (k * k));
  const double x_a = ((1 + q) * r_a - q * k * r_b) * inv_det;
  const double x_b = ((1 + p) * r_b - p * k * r_a) * inv_det;
  const Eigen::Vector3d n = r - (p * x_a) * u_a - (q * x_b) * u_b;
  const double length2 = n.squaredNorm();
  return length2 > 0 ? Eigen::Vector3d(n / std::sqrt(length2)) : u_a;
}

}  // namespace geom::internal
