#pragma once

/// Exact free rotation of a body with three different principal moments.
///
/// **Labels.** 2 is the axis of the middle moment, 3 the outer axis that L circles (that of the largest moment if L^2 >
/// 2 E I2, else that of the smallest), 1 the other outer axis. M = R^T l is the direction of L in the body.
///
/// **In the body** (Landau and Lifshitz, Mechanics, sec. 37): M1 = s1 cn(u, k), M2 = s2 sn(u, k), M3 = s3 dn(u, k), u =
/// u(0) + p t. Each difference is formed without cancellation, except D2, which vanishes on the separatrix:
///
///     D1 = |2 E I1 - L^2| = I2 |I2 - I1| w2^2 + I3 |I3 - I1| w3^2
///     D2 = |2 E I2 - L^2| = I3 |I3 - I2| w3^2 - I1 |I2 - I1| w1^2
///     D3 = |2 E I3 - L^2| = I1 |I3 - I1| w1^2 + I2 |I3 - I2| w2^2
///     s1^2 = I1 D3 / (L^2 |I3 - I1|),   s2^2 = I2 D3 / (L^2 |I3 - I2|),   s3^2 = I3 D1 / (L^2 |I3 - I1|) = 1 - s1^2
///     p^2 = |I3 - I2| D1 / (I1 I2 I3),   k^2 = |I2 - I1| D3 / (|I3 - I2| D1),   k'^2 = |I3 - I1| D2 / (|I3 - I2| D1)
///
/// **About L.** Body axis j rotates about l at phi_j' = (2 E / L - L M_j^2 / I_j) / (1 - M_j^2), an integral of the
/// third kind whose exponential is a theta function (Jacobi; Whittaker, Analytical Dynamics, sec. 69; for simulations
/// van Zon and Schofield, J. Comput. Phys. 225 (2007) 145). With x = pi u / (2 K), eta = pi F(atan(s3 / s1), k') / (2
/// K) and chi = sign(I2 - I1), up to length,
///
///     exp(i phi_3) ~ exp(i lambda t) theta4(x + i chi eta),    exp(i phi_1) ~ exp(i lambda t) theta1(x + i chi eta),
///
/// where lambda follows from phi_3' = L / I2 and phi_1' = 2 E / L at u = K. The angle is computed for axis 3 if s1^2 >=
/// 1/2, else for axis 1 (the leading axis): this axis keeps a distance of at least sqrt(1/2) from l, so there are no
/// poles like those of Euler's angles. The other columns of R follow from M.
///
/// **Series.** k^2 <= 1/2: in the nome q = exp(-pi K'/K) <= exp(-pi), with trigonometric functions of x. k^2 > 1/2, up
/// to the separatrix: Jacobi's imaginary transformation, in q' = exp(-pi K/K') <= exp(-pi), with hyperbolic functions
/// of v = pi u / (2 K') after reduction of u to [-K, K]. In both cases the theta functions are polynomials of degree
/// three in y = 2 cos 2x or y = 2 q' cosh 2v (the next terms are below q^12 = 4e-17), their coefficients computed once
/// a flight: an evaluation costs five polynomials, two sincos or one and an exponential, and two square roots. The
/// constants come from arithmetic-geometric means and square roots.
///
/// **Limiting cases.** Moments that agree to the last bit but one, and L near a stable axis (k -> 0): no loss, all
/// quotients are of positive sums. L on a principal axis to 1e-135: treated as exactly on it. Near the separatrix, D2
/// and hence k' are limited by the rounding of omega; the motion is then as accurate as omega is known (the time of a
/// flip moves by half the relative error of k'^2, over p). On the separatrix, where D2 = 0, it is set to 2^-56 of its
/// terms, which is less than their rounding. L near the unstable axis: k' and the distance from the axis keep all their
/// digits.

#include "motion/elliptic.h"
#include "motion/top_state.h"

#include <Eigen/Core>

#include <array>
#include <optional>

namespace ed::internal {

/// Coefficients of M and phi as functions of time, for one flight.
struct ThetaSeries {
  bool hyperbolic;  ///< whether k^2 > 1/2
  bool lead_is_3;   ///< true: phi is that of axis 3, else of axis 1
  double rate;      ///< rate of x or v
  double secular;   ///< lambda
  Cubic m1, m2, m3, re, im;
  SinCos start;             ///< sine and cosine of x at tau = 0, if trigonometric
  double q;                 ///< nome; this and the following members only if hyperbolic
  double half_period;       ///< 2 K in terms of v
  double edge;              ///< e^v at u = K: q^(-1/2)
  double jump;              ///< increase of phi when u is reduced by 2 K
  double start_exp;         ///< e^v at tau = 0, after reduction
  double start_half_turns;  ///< 0 or 1
};

template <class Archive, Is<ThetaSeries> T>
void fields(Archive& archive, T& s) {
  archive(s.hyperbolic, s.lead_is_3, s.rate, s.secular, s.m1, s.m2, s.m3, s.re, s.im, s.start, s.q, s.half_period,
          s.edge, s.jump, s.start_exp, s.start_half_turns);
}

class AsymmetricTop {
 public:
  AsymmetricTop() = default;  ///< makes an object to be read into

  /// Returns nullopt if omega is along a principal axis (or zero), where it stays. The three moments must differ.
  static std::optional<AsymmetricTop> make(const Eigen::Vector3d& inertia, const Eigen::Matrix3d& rotation,
                                           const Eigen::Vector3d& omega);
  TopState at(double tau) const;
  Eigen::Matrix3d rotation(double tau) const;
  TopBounds bounds() const { return bounds_; }

  /// Returns the integrals of omega by Gauss-Legendre quadrature, up to ten nodes on pieces of at most 1 / max |omega|:
  /// accurate to 1e-14 max |omega| tau, in a time proportional to tau. The component along l in the world is exactly 2
  /// E / L tau.
  TurnedAngles turned(double tau) const;

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.series_, self.axes_, self.rates_, self.euler_, self.orientation_, self.mean_rate_, self.world_,
            self.bounds_);
    expect(archive, are_axes(self.axes_), "the axes of a top");
  }

 private:
  ThetaSeries series_;
  std::array<int, 3> axes_;      ///< body axes in the order leading, next, last: 3, 1, 2 or 1, 2, 3
  std::array<double, 3> rates_;  ///< |L| / I of these axes
  std::array<double, 3> euler_;  ///< (I_j - I_k) / I_i of these axes, i, j, k cyclic in the body
  double orientation_;           ///< handedness of these axes: 1, or -1 if they are left-handed
  double mean_rate_;             ///< 2 E / L
  Eigen::Matrix3d world_;        ///< rotation from the frame of L to the world
  TopBounds bounds_;
};

}  // namespace ed::internal
