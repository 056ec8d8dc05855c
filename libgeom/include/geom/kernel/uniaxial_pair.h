#pragma once

/// Formulas of uniaxial.h for any number type: one pair, or one pair in each lane of a vector. The order of the
/// operations is the same, and so is every bit of the results if the instructions round correctly.
///
/// `Both` holds one number of A and one of B, `Both::Scalar` is such a number, `Vector` three of them. Nothing here
/// includes Eigen: kernels for several instruction sets must not.

namespace geom::kernel {

/// First half of an evaluation: g, the values that its time derivative needs, and the input of the second half.
template <class Both>
struct UniaxialSampleOf {
  typename Both::Scalar g;  ///< n.r - hA(n) - hB(-n)
  typename Both::Scalar z;  ///< n.r
  Both lever;               ///< c x / h: dh/dt = lever * (n.du/dt) at fixed n
  Both x;                   ///< n.u
  Both w2;                  ///< |w|^2, w = u - x n
  Both inv_h;               ///< 1 / h
  Both inv_h2;              ///< 1 / h^2
};

/// Returns g at the unit vector n, for A at the origin and B at r.
template <class Both, class Shape, class Vector>
[[gnu::always_inline]] inline UniaxialSampleOf<Both> uniaxial_gap_of(const Shape& A, const Shape& B, const Vector& r,
                                                                     const Vector& u_a, const Vector& u_b,
                                                                     const Vector& n) {
  // Here and below the order of the operations keeps the dependency chain short, which determines the time.
  const Both ux(u_a.x(), u_b.x()), uy(u_a.y(), u_b.y()), uz(u_a.z(), u_b.z());
  UniaxialSampleOf<Both> out;
  out.x = ux * n.x() + uy * n.y() + uz * n.z();
  const Both wx = ux - out.x * n.x();
  const Both wy = uy - out.x * n.y();
  const Both wz = uz - out.x * n.z();
  out.w2 = wx * wx + wy * wy + wz * wz;
  const Both h2 = Both(A.b2, B.b2) * out.w2 + Both(A.a2, B.a2) * (out.x * out.x);
  const Both h = h2.sqrt();
  out.inv_h2 = 1 / h2;  // computed in parallel with the square root
  out.inv_h = h * out.inv_h2;
  out.z = r.dot(n);
  out.g = (out.z - h[0]) - h[1];
  out.lever = (Both(A.c, B.c) * out.x) * out.inv_h;
  return out;
}

/// Returns whether both eigenvalues, sigma + t1/2 +- sqrt(t1^2/4 - D), are at least `floor`: if and only if the
/// quadratic q^2 + q t1 + D and q + t1/2 are non-negative at q = sigma - floor. The square root is needed only when
/// they are not.
template <class Real>
[[gnu::always_inline]] inline auto definite_above(Real floor, Real sigma, Real t1, Real D) {
  const Real q = sigma - floor;
  return (q * (q + t1) + D >= 0) & (q + 0.5 * t1 >= 0);
}

/// Second half of an evaluation: the Newton step of n, not capped.
template <class Both, class Vector>
struct UniaxialStepOf {
  typename Both::Scalar decrement;  ///< y.delta
  typename Both::Scalar delta2;     ///< |delta|^2
  Vector delta;
};

/// Computes the Newton step. `lift(sigma, t1, D)` returns sigma, raised if the matrix is not definite enough.
template <class Both, class Shape, class Vector, class Lift>
[[gnu::always_inline]] inline UniaxialStepOf<Both, Vector> uniaxial_step_of(const Shape& A, const Shape& B,
                                                                            const Vector& r, const Vector& u_a,
                                                                            const Vector& u_b, const Vector& n,
                                                                            const UniaxialSampleOf<Both>& gap,
                                                                            const Lift& lift) {
  using Real = typename Both::Scalar;
  const Both wx = Both(u_a.x(), u_b.x()) - gap.x * n.x();
  const Both wy = Both(u_a.y(), u_b.y()) - gap.x * n.y();
  const Both wz = Both(u_a.z(), u_b.z()) - gap.x * n.z();
  const Real yx = (r.x() - gap.z * n.x()) - (gap.lever * wx).sum();
  const Real yy = (r.y() - gap.z * n.y()) - (gap.lever * wy).sum();
  const Real yz = (r.z() - gap.z * n.z()) - (gap.lever * wz).sum();
  const Both f = Both(A.b2, B.b2) * gap.inv_h;
  const Both e = (Both(A.c, B.c) * gap.inv_h2) * f;
  const Both e_w2 = e * gap.w2;
  const Real ww = wx[0] * wx[1] + wy[0] * wy[1] + wz[0] * wz[1];
  const Real t1 = e_w2.sum();
  const Real D = e_w2.prod() - e.prod() * (ww * ww);
  const Real sigma = lift(Real(f.sum() + gap.g), t1, D);
  const Real inv_det = 1 / (sigma * (sigma + t1) + D);
  const Both pull = e * (wx * yx + wy * yy + wz * yz);
  const Real s = sigma + t1;
  const Vector adjugate_y(s * yx - (pull * wx).sum(), s * yy - (pull * wy).sum(), s * yz - (pull * wz).sum());
  return {inv_det * (yx * adjugate_y.x() + yy * adjugate_y.y() + yz * adjugate_y.z()),
          (inv_det * inv_det) * adjugate_y.squaredNorm(), inv_det * adjugate_y};
}

/// Returns the cold start: n along (QA + QB)^-1 r, by Woodbury's formula; of any length. Exact for spheres and for
/// parallel coaxial bodies. Zero only for centres that coincide.
template <class Shape, class Vector>
[[gnu::always_inline]] inline Vector cold_direction(const Shape& A, const Shape& B, const Vector& r, const Vector& u_a,
                                                    const Vector& u_b) {
  const auto inv = 1 / (A.b2 + B.b2);
  const auto p = A.c * inv;
  const auto q = B.c * inv;
  const auto k = u_a.dot(u_b);
  const auto r_a = r.dot(u_a);
  const auto r_b = r.dot(u_b);
  const auto det = (1 + p) * (1 + q) - p * q * (k * k);  // > 0
  const auto x_a = (1 + q) * r_a - q * k * r_b;
  const auto x_b = (1 + p) * r_b - p * k * r_a;
  return det * r - (p * x_a) * u_a - (q * x_b) * u_b;
}

/// Returns 1 / sqrt(1 + s) for |s| < kInverseSqrtSeries by its series, whose first omitted term, 231/1024 s^6 < 2e-17,
/// is below rounding. This replaces a square root and a division by a few multiplications in the longest dependency
/// chain.
template <class Real>
[[gnu::always_inline]] inline Real inverse_sqrt_series(Real s) {
  const Real s2 = s * s;  // Estrin's scheme: half the length of Horner's chain
  return (1 - 0.5 * s) + (s2 * (0.375 - 0.3125 * s) + (s2 * s2) * (0.2734375 - 0.24609375 * s));
}

}  // namespace geom::kernel
