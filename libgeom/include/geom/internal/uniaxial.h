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

/// One number of A and one of B: both bodies go through the same operations, two to an SSE2 register.
using Both = Eigen::Array2d;

/// The first half of an evaluation: g, what its time derivative needs, and what the second half goes on with.
struct UniaxialGap {
  double g;     ///< n.r - hA(n) - hB(-n)
  double z;     ///< n.r
  Both lever;   ///< c x / h: dh/dt = lever * (n.du/dt) at fixed n
  Both x;       ///< n.u
  Both w2;      ///< |w|^2, w = u - x n
  Both inv_h;   ///< 1 / h
  Both inv_h2;  ///< 1 / h^2
};

/// An evaluation that also carries what the time derivative of g needs.
struct UniaxialEvaluation : Evaluation {
  Both x;
  Both lever;
};

/// g at the unit vector n, for A at the origin and B at r.
[[gnu::always_inline]] inline UniaxialGap uniaxial_gap(const Spheroid& A, const Spheroid& B, const Eigen::Vector3d& r,
                                                       const Eigen::Vector3d& u_a, const Eigen::Vector3d& u_b,
                                                       const Eigen::Vector3d& n) {
  // Here and below the order of the operations keeps the dependency chain short: it is what the time goes into.
  const Both ux(u_a.x(), u_b.x()), uy(u_a.y(), u_b.y()), uz(u_a.z(), u_b.z());
  UniaxialGap out;
  out.x = ux * n.x() + uy * n.y() + uz * n.z();
  const Both wx = ux - out.x * n.x();
  const Both wy = uy - out.x * n.y();
  const Both wz = uz - out.x * n.z();
  out.w2 = wx * wx + wy * wy + wz * wz;
  const Both h2 = Both(A.b2, B.b2) * out.w2 + Both(A.a2, B.a2) * (out.x * out.x);
  const Both h = h2.sqrt();
  out.inv_h2 = 1 / h2;  // beside the square root, not behind it
  out.inv_h = h * out.inv_h2;
  out.z = r.dot(n);
  out.g = (out.z - h[0]) - h[1];
  out.lever = (Both(A.c, B.c) * out.x) * out.inv_h;
  return out;
}

/// The second half: the Newton step of n.
[[gnu::always_inline]] inline UniaxialEvaluation uniaxial_step(const Spheroid& A, const Spheroid& B,
                                                               const Eigen::Vector3d& r, const Eigen::Vector3d& u_a,
                                                               const Eigen::Vector3d& u_b, const Eigen::Vector3d& n,
                                                               const UniaxialGap& gap) {
  const Both wx = Both(u_a.x(), u_b.x()) - gap.x * n.x();
  const Both wy = Both(u_a.y(), u_b.y()) - gap.x * n.y();
  const Both wz = Both(u_a.z(), u_b.z()) - gap.x * n.z();
  const double yx = (r.x() - gap.z * n.x()) - (gap.lever * wx).sum();
  const double yy = (r.y() - gap.z * n.y()) - (gap.lever * wy).sum();
  const double yz = (r.z() - gap.z * n.z()) - (gap.lever * wz).sum();
  const Both f = Both(A.b2, B.b2) * gap.inv_h;
  const Both e = (Both(A.c, B.c) * gap.inv_h2) * f;
  const Both e_w2 = e * gap.w2;
  const double ww = wx[0] * wx[1] + wy[0] * wy[1] + wz[0] * wz[1];
  const double t1 = e_w2.sum();
  const double D = e_w2.prod() - e.prod() * (ww * ww);
  double sigma = f.sum() + gap.g;
  // Both eigenvalues are at least `floor` if and only if the quadratic q^2 + q t1 + D and q + t1/2 are non-negative at
  // q = sigma - floor; the square root is needed only when they are not.
  // By theory M >= rho = rhoA + rhoB, so that M + g I is definite while g > -rho; deeper it must be made so.
  const double rho = A.rho + B.rho;
  const double floor = kLeastEigenvalue * rho;
  const double q = sigma - floor;
  if (!(q * (q + t1) + D >= 0 && q + 0.5 * t1 >= 0)) [[unlikely]] {
    const double smallest = sigma + 0.5 * t1 - std::sqrt(std::max(0.0, 0.25 * t1 * t1 - D));
    // Only a matrix that is not definite is lifted: a lifted one converges linearly.
    if (smallest < floor) sigma += (gap.g > -rho ? floor : std::max(0.5 * rho, -smallest)) - smallest;
  }
  const double inv_det = 1 / (sigma * (sigma + t1) + D);
  const Both pull = e * (wx * yx + wy * yy + wz * yz);
  const double s = sigma + t1;
  const Eigen::Vector3d adjugate_y(s * yx - (pull * wx).sum(), s * yy - (pull * wy).sum(), s * yz - (pull * wz).sum());
  UniaxialEvaluation out;
  out.g = gap.g;
  out.decrement = inv_det * (yx * adjugate_y.x() + yy * adjugate_y.y() + yz * adjugate_y.z());
  set_step(out, inv_det * adjugate_y, (inv_det * inv_det) * adjugate_y.squaredNorm());
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
  const double det = (1 + p) * (1 + q) - p * q * (k * k);  // > 0
  const double x_a = (1 + q) * r_a - q * k * r_b;
  const double x_b = (1 + p) * r_b - p * k * r_a;
  const Eigen::Vector3d n = det * r - (p * x_a) * u_a - (q * x_b) * u_b;
  const double length2 = n.squaredNorm();
  return length2 > 0 ? Eigen::Vector3d((1 / std::sqrt(length2)) * n) : u_a;
}

}  // namespace geom::internal
