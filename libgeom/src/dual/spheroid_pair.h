#pragma once

/// Two ellipsoids of revolution for the dual Newton (geom/kernel/dual_newton.h), by the formulas of
/// geom/kernel/uniaxial.h: both bodies at once, A in lane 0 and B in lane 1.
///
/// A query is one long chain of dependent operations, whose length determines its time. To shorten it, products of w
/// and the step are sums of numbers that are known before the step is, |w|^2 is |u x n|^2, which does not wait for n.u,
/// and roots are computed in parallel with divisions.

#include <geom/kernel/dual_newton.h>
#include <geom/kernel/uniaxial.h>

#include <Eigen/Core>

#include <algorithm>

namespace geom::kernel {

class SpheroidPair {
 public:
  SpheroidPair(const Spheroid& A, const Spheroid& B, const Eigen::Vector3d& r, const Eigen::Vector3d& u_a,
               const Eigen::Vector3d& u_b)
      : r_(r),
        ux_(u_a.x(), u_b.x()),
        uy_(u_a.y(), u_b.y()),
        uz_(u_a.z(), u_b.z()),
        a2_(A.a2, B.a2),
        b2_(A.b2, B.b2),
        c_(A.c, B.c),
        rho_(A.rho + B.rho) {}

  /// Evaluates g, Newton's step delta and Chebyshev's correction to it, (M + g I)^-1 q, with q half the second
  /// derivative along delta of the mismatch in the plane that touches the sphere at n, P p - (n.p) delta with p the
  /// gradient of n.r - hA - hB at n + delta (y at delta = 0):
  ///
  ///     q = sum of (c x / h^2) { f (w.delta) delta + [3/2 e (w.delta)^2 + 1/2 f |delta|^2] w } over both bodies.
  [[gnu::always_inline]] ChebyshevEvaluation operator()(const Eigen::Vector3d& n) const {
    const Both x = ux_ * n.x() + uy_ * n.y() + uz_ * n.z();
    const Both w2 = sine2(n);
    const Both h2 = b2_ * w2 + a2_ * (x * x);
    const Both h = h2.sqrt();
    const Both inv_h2 = 1 / h2;  // computed in parallel with the square root
    const double z = r_.dot(n);
    const Eigen::Vector3d r_across = r_ - z * n;
    const Both wx = ux_ - x * n.x(), wy = uy_ - x * n.y(), wz = uz_ - x * n.z();
    const double ww = wx[0] * wx[1] + wy[0] * wy[1] + wz[0] * wz[1];

    // M + g I = sigma I + eA wA wA^T + eB wB wB^T
    const Both inv_h = h * inv_h2;
    const Both lever = (c_ * x) * inv_h;
    // The following values are all computed from this y: sums of r.w and of heights that are equal except for rounding
    // would leave errors of the pair's size along w, which a needle's large eigenvalue there does not remove.
    const Eigen::Vector3d y(r_across.x() - (lever * wx).sum(), r_across.y() - (lever * wy).sum(),
                            r_across.z() - (lever * wz).sum());
    const Both w_y = wx * y.x() + wy * y.y() + wz * y.z();
    const Both f = b2_ * inv_h;
    const Both e = (c_ * inv_h2) * f;
    const Both e_w2 = e * w2;
    const double g = (z - h[0]) - h[1];
    const double t = e_w2.sum();
    const double D = e_w2.prod() - e.prod() * (ww * ww);
    const double unlifted = f.sum() + g;
    const double sigma = lifted(g, rho_, unlifted, t, D);
    const double s = sigma + t;
    const double inv_det = 1 / (sigma * s + D);
    const Both pull = e * w_y;
    const Eigen::Vector3d adjugate_y(s * y.x() - (pull * wx).sum(), s * y.y() - (pull * wy).sum(),
                                     s * y.z() - (pull * wz).sum());
    const Eigen::Vector3d delta = inv_det * adjugate_y;
    const double delta2 = (inv_det * inv_det) * adjugate_y.squaredNorm();
    const Both w_delta = inv_det * (s * w_y - (pull * w2 + ww * other(pull)));

    // q = q_delta delta + q_w[0] wA + q_w[1] wB, and the inverse of q_w[0] wA + q_w[1] wB likewise.
    const Both bow = lever * inv_h;
    const double change = (bow * w_delta).abs().maxCoeff();
    const double share = chebyshev_share(change);
    const Both bow_f = bow * f;
    const double q_delta = (bow_f * w_delta).sum();
    const Both q_w = ((1.5 * bow) * e) * (w_delta * w_delta) + (0.5 * bow_f) * delta2;
    const Both inv_det_e = inv_det * e;
    const Both whole_bend_w =
        (inv_det * (s - e_w2)) * q_w - (inv_det_e * w_delta) * q_delta - (inv_det_e * ww) * other(q_w);
    const Both bend_w = share * whole_bend_w;
    const double bend_delta = 1 + share * ((inv_det * s) * q_delta);

    ChebyshevEvaluation out;
    out.g = g;
    out.decrement = y.dot(delta);
    set_step(out, delta, delta2);
    const Eigen::Vector3d bent(bend_delta * delta.x() + (bend_w * wx).sum(),
                               bend_delta * delta.y() + (bend_w * wy).sum(),
                               bend_delta * delta.z() + (bend_w * wz).sum());
    if (sigma == unlifted) [[likely]]
      set_bent_step(out, bent, share * (q_delta * delta2 + (q_w * w_delta).sum()), change);
    return out;
  }

  /// Returns the support points s(n) = (b^2 w' + a^2 x u) / h with w' = n - x u (without the cancellation of b^2 n + c
  /// x u for discs).
  [[gnu::always_inline]] SupportPair support_pair(const Eigen::Vector3d& n) const {
    const Both x = ux_ * n.x() + uy_ * n.y() + uz_ * n.z();
    const Both h2 = b2_ * sine2(n) + a2_ * (x * x);
    const Both h = h2.sqrt();
    const Both signed_inv_h = h * (Both(1, -1) / h2);  // s(-n) = -s(n)
    const Both along = a2_ * x;
    const Both sx = signed_inv_h * (b2_ * (n.x() - x * ux_) + along * ux_);
    const Both sy = signed_inv_h * (b2_ * (n.y() - x * uy_) + along * uy_);
    const Both sz = signed_inv_h * (b2_ * (n.z() - x * uz_) + along * uz_);
    return {h[0], h[1], {sx[0], sy[0], sz[0]}, {sx[1], sy[1], sz[1]}};
  }

  const Eigen::Vector3d& r() const { return r_; }

  /// Returns the cold start of a query: (QA / hA + QB / hB + g I)^-1 r on the unit sphere, with hA, hB and g, if that
  /// is positive, those of the line of centres; r is g n + QA n / hA + QB n / hB at the answer. A's axis for centres
  /// that coincide.
  ///
  /// For bodies whose distance is about their size it is one evaluation nearer to the answer than cold_normal of
  /// uniaxial.h, which is made for bodies that touch, and for bodies that touch it is never further from it.
  [[gnu::always_inline]] Eigen::Vector3d start_normal() const {
    // The following values are for n = r, of any length: numbers of the line of centres are divided by |r|.
    const double r2 = r_.squaredNorm();
    const Both along = ux_ * r_.x() + uy_ * r_.y() + uz_ * r_.z();
    const Both h2 = b2_ * r2 + c_ * (along * along);
    const Both h = h2.sqrt();
    const Both inv_h = h * (1 / h2);
    const double inv_r2 = 1 / r2;
    const double g = std::max(0.0, ((r2 - h[0]) - h[1]) * inv_r2);
    const Both p = c_ * inv_h;
    // sigma I + pA uA uA^T + pB uB uB^T, inverted by Woodbury's formula as in cold_direction.
    const double sigma = (b2_ * inv_h).sum() + g;
    const double k = ux_.prod() + uy_.prod() + uz_.prod();
    const Both of = sigma + p;
    const double det = of.prod() - p.prod() * (k * k);
    const Both x = p * (other(of) * along - (k * other(p)) * other(along));
    const Eigen::Vector3d n(det * r_.x() - (x * ux_).sum(), det * r_.y() - (x * uy_).sum(),
                            det * r_.z() - (x * uz_).sum());
    return unit_or(n, {ux_[0], uy_[0], uz_[0]});
  }

 private:
  /// Exchanges the lanes of A and B.
  static Both other(const Both& v) { return {v[1], v[0]}; }

  /// Returns |u x n|^2, which is |w|^2.
  Both sine2(const Eigen::Vector3d& n) const {
    const Both x = uy_ * n.z() - uz_ * n.y();
    const Both y = uz_ * n.x() - ux_ * n.z();
    const Both z = ux_ * n.y() - uy_ * n.x();
    return x * x + y * y + z * z;
  }

  Eigen::Vector3d r_;
  Both ux_, uy_, uz_;  ///< axes of revolution
  Both a2_, b2_, c_;
  double rho_;
};

}  // namespace geom::kernel
