#pragma once

/// Two bodies {x : N(x/a) <= 1}, N a nested norm (kernel/nested_norm.h), evaluated at once: superellipsoids, or one of
/// them with an ellipsoid.

#include <geom/ellipsoid.h>
#include <geom/kernel/lane_norms.h>
#include <geom/kernel/lanes.h>
#include <geom/superellipsoid.h>

#include <Eigen/Core>

namespace geom::kernel {

/// Semi-axes and exponents of a shape.
struct NormShape {
  explicit NormShape(const Superellipsoid& s) : semi_axes(s.semi_axes()), e1(s.e1()), e2(s.e2()) {}
  explicit NormShape(const Ellipsoid& s) : semi_axes(s.semi_axes()), e1(1), e2(1) {}

  Eigen::Vector3d semi_axes;
  double e1, e2;
};

/// Pair of bodies in world axes, each about its own centre.
class NormBodies {
 public:
  NormBodies(const NormShape& a, const Eigen::Matrix3d& R_a, const NormShape& b, const Eigen::Matrix3d& R_b)
      : NormBodies(LaneVector::of(a.semi_axes, b.semi_axes), LaneRotation::of(R_a, R_b), Lanes{a.e1, b.e1},
                   Lanes{a.e2, b.e2}) {}

  const LaneVector& semi_axes() const { return axes_; }
  const LaneVector& inverse_semi_axes() const { return inverse_axes_; }
  const LaneRotation& rotation() const { return R_; }
  Lanes e1() const { return e1_; }
  Lanes e2() const { return e2_; }

  /// Returns the sum of R diag(a^2) R^T over both bodies.
  Eigen::Matrix3d quadrics() const {
    const LaneVector u = axes_.x * R_.x;
    const LaneVector v = axes_.y * R_.y;
    const LaneVector w = axes_.z * R_.z;
    Eigen::Matrix3d Q = Eigen::Matrix3d::Zero();
    for (const LaneVector* t : {&u, &v, &w}) Q += t->a() * t->a().transpose() + t->b() * t->b().transpose();
    return Q;
  }

  /// Returns the arguments of the dual norm: a n in body axes, for n (A) and -n (B).
  LaneVector in_norm(const Eigen::Vector3d& n) const {
    return product(axes_, R_.transposed_times(LaneVector::of(n, -n)));
  }

  /// Heights, points and the Hessians of the support functions, t1 t1^T + t2 t2^T.
  struct Support {
    Lanes height;
    LaneVector point;
    LaneVector t1, t2;
    // Input of a majorant.
    LaneVector w;      ///< a |n|, body axes
    LaneVector scale;  ///< semi-axes with the signs of n
    LanePlaneNorm::Value inner, outer;
  };

  /// Returns the supports of A at n and of B at -n, n a unit vector.
  Support support(const Eigen::Vector3d& n) const {
    const LaneVector v = in_norm(n);
    const LaneVector w = abs(v);
    const LaneNorm::Curved at = dual_.curved(w);
    const LaneVector scale = signed_like(axes_, v);
    return {at.norm,
            R_ * product(at.gradient, scale),
            R_ * product(at.across, scale),
            R_ * product(at.along, scale),
            w,
            scale,
            at.levels.inner,
            at.levels.outer};
  }
  Lanes heights(const LaneVector& n) const { return dual_(abs(product(axes_, R_.transposed_times(n)))).norm; }

  /// An ellipsoid that holds each body and nearly touches it at its support point: for every change dm of the direction
  /// in the body's axes (D2 too is in these, `gradient` in world axes)
  ///
  ///     h(m + dm) <= h + offset + gradient.dm + sum_i D2_i dm_i^2 / (2 height).
  ///
  /// Why. In w = a m the support function is N1(N2(w0, w1), w2). For q <= 2, N^2 is a concave 1-homogeneous function of
  /// the squares u^2, v^2, hence below its tangent at any (U, V): N(u, v)^2 <= A u^2 + B v^2, A = (U/N)^(q-2), B =
  /// (V/N)^(q-2), N = N(U, V), with equality at (U, V). For q > 2, N(u + du, v + dv)^2 <= N^2 + 2 N dN.(du, dv) + (q -
  /// 1) N(du, dv)^2 (Ball, Carlen and Lieb, Invent. Math. 115 (1994) 463), and N(du, dv)^2 <= du^2 + dv^2. Nested, with
  /// hr = dN1/drho, rho = N2:
  ///   q1 <= 2: h'^2 <= A1 rho'^2 + B1 w2'^2, and rho'^2 <= rho^2 + 2 rho drho.du + sum_i Q_i du_i^2, Q_i = A2, B2 for
  ///     q2 <= 2 and q2 - 1 otherwise: D2 = a^2 (A1 Q_0, A1 Q_1, B1);
  ///   q1 > 2: with rho' <= rho + drho.du + sum_i Q_i du_i^2 / (2 rho) in 2 h hr (rho' - rho), and (rho' - rho)^2 <=
  ///     N2(du)^2 <= f |du|^2, f = 2^(2/q2 - 1) for q2 < 2 and 1 otherwise: D2_0,1 = a^2 [h hr Q_i / rho + (q1 - 1) f],
  ///     D2_2 = a^2 (q1 - 1).
  /// Last sqrt(h^2 + 2 h x) <= h + x.
  ///
  /// On a flat face w_i -> 0 with q < 2 and D2 has no bound. There the tangent is taken at (U, V) with the small one
  /// raised to T N: an ellipsoid that is larger at n, by at most `allowance` or so, the offset.
  struct Majorant {
    LaneVector D2;
    LaneVector gradient;
    Lanes offset;
    Lanes height;
    bool raised;  ///< some w_i was raised
  };
  Majorant majorant(const Support& s, double allowance) const;
  LaneVector to_body(const LaneVector& v) const { return R_.transposed_times(v); }

  /// Returns the outward normals of the surfaces at x, or at the surface points in their direction: N is homogeneous.
  LaneVector normals(const LaneVector& x) const {
    const LaneVector w = product(inverse_axes_, R_.transposed_times(x));
    return normalized(R_ * product(norm_(abs(w)).gradient, signed_like(inverse_axes_, w)));
  }
  /// Returns N(x/a): at most 1 in the body.
  Lanes norms(const LaneVector& x) const { return norm_(abs(product(inverse_axes_, R_.transposed_times(x)))).norm; }
  LaneVector on_surface(const LaneVector& x) const { return (1 / norms(x)) * x; }

 private:
  NormBodies(const LaneVector& axes, const LaneRotation& R, Lanes e1, Lanes e2)
      : axes_(axes),
        inverse_axes_{1 / axes.x, 1 / axes.y, 1 / axes.z},
        R_(R),
        e1_(e1),
        e2_(e2),
        norm_(2 / e1, 2 / e2),
        dual_(2 / (2 - e1), 2 / (2 - e2)) {}

  static LaneVector signed_like(const LaneVector& size, const LaneVector& sign) {
    return {with_sign(size.x, sign.x), with_sign(size.y, sign.y), with_sign(size.z, sign.z)};
  }

  /// Tangent (A, B) of a plane norm, q < 2, at (x, y)/N; a component below `floor` is raised to it.
  struct Weights {
    Lanes a, b;
  };
  static Weights raised_weights(Lanes q, Lanes x, Lanes y, Lanes floor);
  static Lanes floor_for(Lanes q, Lanes allowance);

  /// Tangents of the inner and the outer norm that enter a majorant; see there.
  struct InnerTangent {
    Weights Q;
    Lanes R2;
    Lanes x, y;
    LaneBits raised;
  };
  struct OuterTangent {
    Weights A;
    LaneBits raised;
  };
  InnerTangent inner_tangent(const Support& s, Lanes rho, Lanes relative) const;
  OuterTangent outer_tangent(const Support& s, Lanes rho, Lanes relative) const;

  /// rho is kept above this fraction of h: rho = 0 for n along body z.
  static constexpr double kLeastRho = 1e-30;
  /// An exponent below 2 for lanes whose result is not used.
  static constexpr double kAnyFlat = 1.5;

  LaneVector axes_;
  LaneVector inverse_axes_;
  LaneRotation R_;
  Lanes e1_, e2_;
  LaneNorm norm_;  ///< norm of x/a
  LaneNorm dual_;  ///< norm of a n
};

/// Returns x^e for positive x.
inline Lanes power(Lanes x, Lanes e) {
  return exp(e * log(x));
}

/// Returns the T for which the norm is raised by the allowance: at (U, V)/N it is raised by about T^q (1/q - 1/2).
inline Lanes NormBodies::floor_for(Lanes q, Lanes allowance) {
  constexpr double kLeast = 1e-15;  // an offset below rounding
  constexpr double kMost = 0.3;
  const Lanes T = power(allowance / (1 / q - 0.5) + 1e-300, 1 / q);
  return select(below(T, both(kLeast)), both(kLeast), select(below(both(kMost), T), both(kMost), T));
}

inline NormBodies::Weights NormBodies::raised_weights(Lanes q, Lanes x, Lanes y, Lanes floor) {
  const Lanes X = select(below(x, floor), floor, x);
  const Lanes Y = select(below(y, floor), floor, y);
  const Lanes px = power(X, q - 2);
  const Lanes py = power(Y, q - 2);
  const Lanes Z = power(px * X * X + py * Y * Y, (2 - q) / q);
  return {Z * px, Z * py};
}

/// Returns the tangent of rho' = N2 (see Majorant): Q_i, R2 = sum of Q_i w_i^2 for q2 < 2, which is rho^2 or a little
/// more, and half the derivative of rho'^2.
inline NormBodies::InnerTangent NormBodies::inner_tangent(const Support& s, Lanes rho, Lanes relative) const {
  const Lanes q2 = dual_.inner().exponent();
  const LaneBits flat = below(q2, both(2));
  const Lanes x0 = s.w.x / rho;
  const Lanes x1 = s.w.y / rho;
  const Lanes least = floor_for(select(flat, q2, both(kAnyFlat)), relative);
  InnerTangent t;
  t.raised = flat & (below(x0, least) | below(x1, least));
  t.Q = {s.inner.du / x0, s.inner.dv / x1};
  t.R2 = rho * rho;
  t.x = rho * s.inner.du;
  t.y = rho * s.inner.dv;
  if (any(t.raised)) {
    const Weights raised = raised_weights(select(flat, q2, both(kAnyFlat)), x0, x1, least);
    t.Q = {select(t.raised, raised.a, t.Q.a), select(t.raised, raised.b, t.Q.b)};
    const Lanes larger = t.Q.a * s.w.x * s.w.x + t.Q.b * s.w.y * s.w.y;
    t.R2 = select(t.raised & below(t.R2, larger), larger, t.R2);
    t.x = select(t.raised, t.Q.a * s.w.x, t.x);
    t.y = select(t.raised, t.Q.b * s.w.y, t.y);
  }
  const Lanes curved = q2 - 1;
  t.Q = {select(flat, t.Q.a, curved), select(flat, t.Q.b, curved)};
  return t;
}

/// Returns the tangent of h' = N1 for q1 <= 2: h'^2 <= A rho'^2 + B w2'^2.
inline NormBodies::OuterTangent NormBodies::outer_tangent(const Support& s, Lanes rho, Lanes relative) const {
  const Lanes q1 = dual_.outer().exponent();
  const LaneBits flat = below(q1, both(2));
  const Lanes h = s.outer.norm;
  const Lanes rh = rho / h;
  const Lanes zh = s.w.z / h;
  const Lanes least = floor_for(select(flat, q1, both(kAnyFlat)), relative);
  OuterTangent t{{s.outer.du / rh, s.outer.dv / zh}, flat & (below(rh, least) | below(zh, least))};
  if (any(t.raised)) {
    const Weights raised = raised_weights(select(flat, q1, both(kAnyFlat)), rh, zh, least);
    t.A = {select(t.raised, raised.a, t.A.a), select(t.raised, raised.b, t.A.b)};
  }
  return t;
}

/// Computes each quantity for q1 <= 2 and for q1 > 2; each lane selects its own.
inline NormBodies::Majorant NormBodies::majorant(const Support& s, double allowance) const {
  const Lanes two = both(2);
  const Lanes q1 = dual_.outer().exponent();
  const Lanes q2 = dual_.inner().exponent();
  const LaneBits flat = below(q1, two);
  const Lanes h = s.outer.norm;
  const Lanes least = kLeastRho * h;
  const Lanes rho = select(below(s.inner.norm, least), least, s.inner.norm);
  const Lanes relative = allowance / h;
  const InnerTangent in = inner_tangent(s, rho, relative);
  const OuterTangent out = outer_tangent(s, rho, relative);

  const Lanes outer2 = out.A.a * in.R2 + out.A.b * s.w.z * s.w.z;
  const Lanes E = sqrt(select(below(h * h, outer2), outer2, h * h));
  const Lanes rt = sqrt(in.R2);
  const Lanes f = select(below(q2, two), power(two, 2 / q2 - 1), both(1));
  const Lanes k = q1 - 1;
  const Lanes u = h * s.outer.du / rt;

  Majorant m;
  const LaneVector axes2 = product(axes_, axes_);
  m.D2.x = axes2.x * select(flat, out.A.a * in.Q.a, u * in.Q.a + k * f);
  m.D2.y = axes2.y * select(flat, out.A.a * in.Q.b, u * in.Q.b + k * f);
  m.D2.z = axes2.z * select(flat, out.A.b, k);
  m.height = select(flat, E, h);
  m.offset = select(flat, E - h, s.outer.du * (rt - rho));
  const LaneVector gradient{select(flat, out.A.a * in.x / E, s.outer.du * in.x / rt),
                            select(flat, out.A.a * in.y / E, s.outer.du * in.y / rt),
                            select(flat, out.A.b * s.w.z / E, s.outer.dv)};
  m.gradient = R_ * product(gradient, s.scale);
  m.raised = any(in.raised | out.raised);
  return m;
}

}  // namespace geom::kernel
