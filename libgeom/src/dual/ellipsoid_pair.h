#pragma once

/// Two ellipsoids with any semi-axes for the dual Newton (geom/kernel/dual_newton.h): both bodies at once, A in lane 0
/// and B in lane 1, in the world frame.
///
/// With U = diag(a) R^T and Q = U^T U = R diag(a^2) R^T,
///
///     h = |U n| = sqrt(n.Q n),   s = Q n / h,   H = (Q - s s^T) / h,
///
/// and H = HA + HB maps n to 0. Hence T = trace H and D, the sum of its principal minors, are the sum and the product
/// of its two eigenvalues across n, and the Cayley-Hamilton theorem solves (H + sigma I) delta = y without a basis
/// there:
///
///     delta = [(T + sigma) y - H y] / [sigma (sigma + T) + D].

#include <geom/ellipsoid.h>
#include <geom/kernel/dual_newton.h>
#include <geom/kernel/uniaxial.h>
#include <geom/pose.h>

#include <Eigen/Core>

#include <algorithm>

namespace geom::kernel {

class EllipsoidPair {
 public:
  EllipsoidPair(const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB, const Eigen::Vector3d& r)
      : r_(r), rho_(a.min_curvature_radius() + b.min_curvature_radius()) {
    const Eigen::Matrix3d& R_WA = X_WA.rotation();
    const Eigen::Matrix3d& R_WB = X_WB.rotation();
    for (int i = 0; i < 3; ++i) {
      const Both a_i(a.semi_axes()[i], b.semi_axes()[i]);
      for (int k = 0; k < 3; ++k) U_[i][k] = a_i * Both(R_WA(k, i), R_WB(k, i));
    }
    const auto entry = [this](int j, int k) -> Both {
      return U_[0][j] * U_[0][k] + (U_[1][j] * U_[1][k] + U_[2][j] * U_[2][k]);
    };
    Q_ = {entry(0, 0), entry(1, 1), entry(2, 2), entry(1, 2), entry(0, 2), entry(0, 1)};
  }

  /// Evaluates g and its step at n. The step is Chebyshev's (spheroid_pair.h), with half the second derivative of the
  /// mismatch along delta
  ///
  ///     q = P sum of [(s.delta) H delta + 1/2 (delta.H delta) s] / h over both bodies.
  [[gnu::always_inline]] ChebyshevEvaluation operator()(const Eigen::Vector3d& n) const {
    const Curved at_n = curved(n);
    const Symmetric<double>& H = at_n.hessian;
    const double g = (at_n.z - at_n.h[0]) - at_n.h[1];
    const Eigen::Vector3d y = (r_ - g * n) - Eigen::Vector3d(at_n.sx.sum(), at_n.sy.sum(), at_n.sz.sum());
    const double T = (H.xx + H.yy) + H.zz;
    const double D = (H.xx * H.yy - H.xy * H.xy) + (H.yy * H.zz - H.yz * H.yz) + (H.xx * H.zz - H.xz * H.xz);
    const double sigma = lifted(g, rho_, g, T, D);
    const double inv_det = 1 / (sigma * (sigma + T) + D);
    const double s = sigma + T;
    const auto adjugate_times = [&](const Eigen::Vector3d& v) {
      return Eigen::Vector3d((s - H.xx) * v.x() - (H.xy * v.y() + H.xz * v.z()),
                             (s - H.yy) * v.y() - (H.xy * v.x() + H.yz * v.z()),
                             (s - H.zz) * v.z() - (H.xz * v.x() + H.yz * v.y()));
    };
    const Eigen::Vector3d adjugate_y = adjugate_times(y);
    ChebyshevEvaluation out;
    out.g = g;
    out.decrement = inv_det * y.dot(adjugate_y);
    const Eigen::Vector3d delta = inv_det * adjugate_y;
    set_step(out, delta, (inv_det * inv_det) * adjugate_y.squaredNorm());
    const Bend bend = bend_along(at_n, n, adjugate_y, inv_det);
    const double share = chebyshev_share(bend.change);
    const Eigen::Vector3d bent = delta + (share * inv_det) * adjugate_times(bend.q);
    if (sigma == g) [[likely]]
      set_bent_step(out, bent, share * bend.q.dot(delta), bend.change);
    return out;
  }

  /// Returns heights and points, computed by U, which loses no digits for flat bodies, unlike n.Q n.
  [[gnu::always_inline]] SupportPair support_pair(const Eigen::Vector3d& n) const {
    const Both m0 = U_[0][0] * n.x() + (U_[0][1] * n.y() + U_[0][2] * n.z());
    const Both m1 = U_[1][0] * n.x() + (U_[1][1] * n.y() + U_[1][2] * n.z());
    const Both m2 = U_[2][0] * n.x() + (U_[2][1] * n.y() + U_[2][2] * n.z());
    const Both h2 = m0 * m0 + (m1 * m1 + m2 * m2);
    const Both h = h2.sqrt();
    const Both signed_inv_h = h * (Both(1, -1) / h2);  // s(-n) = -s(n)
    const Both c0 = m0 * signed_inv_h, c1 = m1 * signed_inv_h, c2 = m2 * signed_inv_h;
    const Both sx = c0 * U_[0][0] + (c1 * U_[1][0] + c2 * U_[2][0]);
    const Both sy = c0 * U_[0][1] + (c1 * U_[1][1] + c2 * U_[2][1]);
    const Both sz = c0 * U_[0][2] + (c1 * U_[1][2] + c2 * U_[2][2]);
    return {h[0], h[1], {sx[0], sy[0], sz[0]}, {sx[1], sy[1], sz[1]}};
  }

  const Eigen::Vector3d& r() const { return r_; }

  /// Returns a unit vector across n along which g curves upwards by more than `rounding` / rad^2; zero if there is
  /// none.
  Eigen::Vector3d upward(const Eigen::Vector3d& n, double rounding) const {
    const Curved at_n = curved(n);
    const TangentBasis basis(n);
    const double g = (at_n.z - at_n.h[0]) - at_n.h[1];
    return TangentForm::of(at_n.hessian.matrix(), g, basis).direction_below(-rounding, basis);
  }

  /// Returns Q of A (lane 0) or B (1).
  Eigen::Matrix3d quadric(int lane) const { return Q_.lane(lane).matrix(); }

  /// Returns the start of a query, see SpheroidPair::start_normal; x for centres that coincide.
  [[gnu::always_inline]] Eigen::Vector3d start_normal() const {
    const double r2 = r_.squaredNorm();
    const Both h2 = Q_.times(r_, r_);
    const Both h = h2.sqrt();
    const Both inv_h = h * (1 / h2);
    const double inv_r2 = 1 / r2;
    const double g = std::max(0.0, ((r2 - h[0]) - h[1]) * inv_r2);
    const Symmetric<double> M = {(inv_h * Q_.xx).sum() + g, (inv_h * Q_.yy).sum() + g, (inv_h * Q_.zz).sum() + g,
                                 (inv_h * Q_.yz).sum(),     (inv_h * Q_.xz).sum(),     (inv_h * Q_.xy).sum()};
    const double yz = M.xy * M.xz - M.xx * M.yz;
    const double xz = M.xy * M.yz - M.yy * M.xz;
    const double xy = M.xz * M.yz - M.zz * M.xy;
    const Eigen::Vector3d n((M.yy * M.zz - M.yz * M.yz) * r_.x() + (xy * r_.y() + xz * r_.z()),
                            (M.xx * M.zz - M.xz * M.xz) * r_.y() + (xy * r_.x() + yz * r_.z()),
                            (M.xx * M.yy - M.xy * M.xy) * r_.z() + (xz * r_.x() + yz * r_.y()));
    return unit_or(n, Eigen::Vector3d::UnitX());
  }

 private:
  template <class Real>
  struct Symmetric {
    Real xx, yy, zz, yz, xz, xy;

    Real times(const Eigen::Vector3d& n, const Eigen::Vector3d& m) const {
      return (xx * n.x() + (xy * n.y() + xz * n.z())) * m.x() +
             ((xy * n.x() + (yy * n.y() + yz * n.z())) * m.y() + (xz * n.x() + (yz * n.y() + zz * n.z())) * m.z());
    }
    Symmetric<double> lane(int k) const { return {xx[k], yy[k], zz[k], yz[k], xz[k], xy[k]}; }
    Eigen::Matrix3d matrix() const {
      Eigen::Matrix3d m;
      m << xx, xy, xz, xy, yy, yz, xz, yz, zz;
      return m;
    }
  };

  /// Heights and support points of both bodies at n, and the sum of their Hessians.
  struct Curved {
    double z;  ///< n.r
    Both h, inv_h, sx, sy, sz;
    Symmetric<double> hessian;
  };

  struct Bend {
    double change;      ///< larger change of the logarithm of the two heights
    Eigen::Vector3d q;  ///< q of operator()
  };

  /// Returns the bend along delta = length * v, where `length` is known later than v.
  [[gnu::always_inline]] Bend bend_along(const Curved& at_n, const Eigen::Vector3d& n, const Eigen::Vector3d& v,
                                         double length) const {
    const Both Qx = Q_.xx * v.x() + (Q_.xy * v.y() + Q_.xz * v.z());
    const Both Qy = Q_.xy * v.x() + (Q_.yy * v.y() + Q_.yz * v.z());
    const Both Qz = Q_.xz * v.x() + (Q_.yz * v.y() + Q_.zz * v.z());
    const Both s_v = at_n.inv_h * (at_n.sx * v.x() + (at_n.sy * v.y() + at_n.sz * v.z()));
    const Both vQv = at_n.inv_h * (0.5 * (Qx * v.x() + (Qy * v.y() + Qz * v.z())));
    // H v = Q v / h - s_v s.
    const Both change = length * s_v;
    const double length2 = length * length;
    const Both of_Q = (length * at_n.inv_h) * change;
    const Both of_s = length2 * (at_n.inv_h * vQv - 1.5 * (s_v * s_v));
    const double along_n = length2 * (vQv - (0.5 * (s_v * s_v)) * at_n.h).sum();
    return {change.abs().maxCoeff(),
            {(of_Q * Qx + of_s * at_n.sx).sum() - along_n * n.x(), (of_Q * Qy + of_s * at_n.sy).sum() - along_n * n.y(),
             (of_Q * Qz + of_s * at_n.sz).sum() - along_n * n.z()}};
  }

  [[gnu::always_inline]] Curved curved(const Eigen::Vector3d& n) const {
    const Both qx = Q_.xx * n.x() + (Q_.xy * n.y() + Q_.xz * n.z());
    const Both qy = Q_.xy * n.x() + (Q_.yy * n.y() + Q_.yz * n.z());
    const Both qz = Q_.xz * n.x() + (Q_.yz * n.y() + Q_.zz * n.z());
    const Both h2 = qx * n.x() + (qy * n.y() + qz * n.z());
    Curved out;
    out.z = r_.dot(n);
    out.h = h2.sqrt();
    const Both inv_h = out.h * (1 / h2);  // computed in parallel with the square root
    out.inv_h = inv_h;
    out.sx = inv_h * qx;
    out.sy = inv_h * qy;
    out.sz = inv_h * qz;
    const Both kx = inv_h * out.sx, ky = inv_h * out.sy, kz = inv_h * out.sz;
    out.hessian = {(inv_h * Q_.xx - kx * out.sx).sum(), (inv_h * Q_.yy - ky * out.sy).sum(),
                   (inv_h * Q_.zz - kz * out.sz).sum(), (inv_h * Q_.yz - ky * out.sz).sum(),
                   (inv_h * Q_.xz - kx * out.sz).sum(), (inv_h * Q_.xy - kx * out.sy).sum()};
    return out;
  }

  Eigen::Vector3d r_;
  double rho_;
  Both U_[3][3];  ///< [i][k]: row i of U
  Symmetric<Both> Q_;
};

}  // namespace geom::kernel
