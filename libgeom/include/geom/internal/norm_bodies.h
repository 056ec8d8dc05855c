#pragma once

/// Two bodies {x : N(x/a) <= 1}, N a nested norm (internal/nested_norm.h), evaluated at once: superellipsoids, and
/// ellipsoids beside them.

#include <geom/ellipsoid.h>
#include <geom/internal/lanes.h>
#include <geom/superellipsoid.h>

#include <Eigen/Core>

namespace geom::internal {

/// Nk(u, v) = (u^q + v^q)^(1/q), u, v >= 0, as in PlaneNorm, by logarithms.
///
/// With t = v/u <= 1: t^(q-1) = exp((q - 1) ln t), whose relative error, |(q - 1) ln t| epsilon, grows no faster than
/// the value falls, so that everything is exact to some epsilon of the norm.
class LanePlaneNorm {
 public:
  explicit LanePlaneNorm(Lanes q) : minus_one_(q - 1), inverse_(1 / q) {}

  Lanes exponent() const { return 1 + minus_one_; }

  struct Value {
    Lanes norm;
    Lanes du, dv;    ///< (u / N)^(q-1)
    Lanes log_norm;  ///< ln N
  };

  Value operator()(Lanes u, Lanes v, Lanes log_u, Lanes log_v) const {
    const LaneBits swapped = below(u, v);
    const Lanes larger = select(swapped, v, u);
    const Lanes smaller = select(swapped, u, v);
    const Lanes log_larger = select(swapped, log_v, log_u);
    const Lanes log_t = select(swapped, log_u, log_v) - log_larger;
    const Lanes zero = both(0);
    const Lanes t = smaller / select(below(zero, larger), larger, both(1));
    const Lanes p = select(below(zero, smaller), exp(minus_one_ * log_t), zero);  // t^(q-1)
    const Lanes s = 1 + t * p;
    const Lanes log_root = log(s) * inverse_;
    const Lanes root = exp(log_root);
    const Lanes d_larger = root / s;  // s^(1/q - 1)
    const Lanes d_smaller = p * d_larger;
    return {larger * root, select(swapped, d_smaller, d_larger), select(swapped, d_larger, d_smaller),
            log_larger + log_root};
  }

  /// l of the Hessian l (v, -u)(v, -u)^T; u, v > 0.
  Lanes curvature(const Value& at, Lanes u, Lanes v) const { return minus_one_ * (at.du / u) * (at.dv / v) / at.norm; }

 private:
  Lanes minus_one_;
  Lanes inverse_;
};

class LaneNorm {
 public:
  LaneNorm(Lanes q1, Lanes q2) : outer_(q1), inner_(q2) {}

  struct Value {
    Lanes norm;
    LaneVector gradient;  ///< dN/dw, each in [0, 1]
  };
  /// With the Hessian, across across^T + along along^T.
  struct Curved : Value {
    LaneVector across;  ///< in the plane of w0 and w1
    LaneVector along;
    LanePlaneNorm::Value inner, outer;
  };

  const LanePlaneNorm& outer() const { return outer_; }
  const LanePlaneNorm& inner() const { return inner_; }

  Value operator()(const LaneVector& w) const {
    LanePlaneNorm::Value inner, outer;
    evaluate(w, inner, outer);
    return value(inner, outer);
  }

  /// Both vectors are orthogonal to w to rounding. Where a w vanishes and q < 2 (a flat face) the Hessian is infinite;
  /// there it is that of w kept above kLeast of the largest, which is huge.
  Curved curved(const LaneVector& w) const {
    const Lanes larger = select(below(w.x, w.y), w.y, w.x);
    const Lanes least = kLeast * select(below(larger, w.z), w.z, larger);
    const LaneBits vanishing = below(w.x, least) | below(w.y, least) | below(w.z, least);
    if (any(vanishing)) [[unlikely]] {
      const auto lifted = [&least](Lanes v) { return select(below(v, least), 2 * least, v); };
      Curved at = curved({lifted(w.x), lifted(w.y), lifted(w.z)});
      evaluate(w, at.inner, at.outer);
      static_cast<Value&>(at) = value(at.inner, at.outer);
      return at;
    }
    LanePlaneNorm::Value inner, outer;
    evaluate(w, inner, outer);
    const Lanes k_inner = sqrt(outer.du * inner_.curvature(inner, w.x, w.y));
    const Lanes k_outer = sqrt(outer_.curvature(outer, inner.norm, w.z));
    return {value(inner, outer),
            {k_inner * w.y, -k_inner * w.x, both(0)},
            {k_outer * w.z * inner.du, k_outer * w.z * inner.dv, -k_outer * inner.norm},
            inner,
            outer};
  }

 private:
  static constexpr double kLeast = 1e-20;

  void evaluate(const LaneVector& w, LanePlaneNorm::Value& inner, LanePlaneNorm::Value& outer) const {
    const Lanes log_z = log(w.z);
    inner = inner_(w.x, w.y, log(w.x), log(w.y));
    outer = outer_(inner.norm, w.z, inner.log_norm, log_z);
  }
  static Value value(const LanePlaneNorm::Value& inner, const LanePlaneNorm::Value& outer) {
    return {outer.norm, {outer.du * inner.du, outer.du * inner.dv, outer.dv}};
  }

  LanePlaneNorm outer_;
  LanePlaneNorm inner_;
};

/// A shape's semi-axes and exponents.
struct NormShape {
  explicit NormShape(const Superellipsoid& s) : semi_axes(s.semi_axes()), e1(s.e1()), e2(s.e2()) {}
  explicit NormShape(const Ellipsoid& s) : semi_axes(s.semi_axes()), e1(1), e2(1) {}

  Eigen::Vector3d semi_axes;
  double e1, e2;
};

/// Both bodies in world axes, each about its own centre.
class NormBodies {
 public:
  NormBodies(const NormShape& a, const Eigen::Matrix3d& R_a, const NormShape& b, const Eigen::Matrix3d& R_b)
      : NormBodies(LaneVector::of(a.semi_axes, b.semi_axes), LaneRotation::of(R_a, R_b), Lanes{a.e1, b.e1},
                   Lanes{a.e2, b.e2}) {}

  /// The same with exponents e' = 1 + share (e - 1), drawn towards those of an ellipsoid.
  NormBodies softened(double share) const { return {axes_, R_, 1 + share * (e1_ - 1), 1 + share * (e2_ - 1)}; }

  /// Sum of R diag(a^2) R^T of both.
  Eigen::Matrix3d quadrics() const {
    const LaneVector u = axes_.x * R_.x;
    const LaneVector v = axes_.y * R_.y;
    const LaneVector w = axes_.z * R_.z;
    Eigen::Matrix3d Q = Eigen::Matrix3d::Zero();
    for (const LaneVector* t : {&u, &v, &w}) Q += t->a() * t->a().transpose() + t->b() * t->b().transpose();
    return Q;
  }

  /// Heights, points and the Hessians of the support functions, t1 t1^T + t2 t2^T.
  struct Support {
    Lanes height;
    LaneVector point;
    LaneVector t1, t2;
    // What a majorant is made of.
    LaneVector w;      ///< a |n|, body axes
    LaneVector scale;  ///< the semi-axes with the signs of n
    LanePlaneNorm::Value inner, outer;
  };

  /// Of A at n and of B at -n, n a unit vector.
  Support support(const Eigen::Vector3d& n) const {
    const LaneVector v = in_norm(n);
    const LaneVector w = magnitudes(v);
    const LaneNorm::Curved at = dual_.curved(w);
    const LaneVector scale = signed_like(axes_, v);
    return {at.norm,
            R_ * product(at.gradient, scale),
            R_ * product(at.across, scale),
            R_ * product(at.along, scale),
            w,
            scale,
            at.inner,
            at.outer};
  }
  Lanes heights(const LaneVector& n) const { return dual_(magnitudes(product(axes_, R_.transposed_times(n)))).norm; }

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
    bool raised;  ///< some w_i was
  };
  Majorant majorant(const Support& s, double allowance) const;
  LaneVector to_body(const LaneVector& v) const { return R_.transposed_times(v); }

  /// The outward normals of the surfaces at x, or at the surface points in their direction: N is homogeneous.
  LaneVector normals(const LaneVector& x) const {
    const LaneVector w = product(inverse_axes_, R_.transposed_times(x));
    return normalized(R_ * product(norm_(magnitudes(w)).gradient, signed_like(inverse_axes_, w)));
  }
  /// N(x/a): at most 1 in the body.
  Lanes norms(const LaneVector& x) const {
    return norm_(magnitudes(product(inverse_axes_, R_.transposed_times(x)))).norm;
  }
  LaneVector on_surface(const LaneVector& x) const { return (1 / norms(x)) * x; }
  /// grad N, and hess N = t1 t1^T + t2 t2^T, of points of the surfaces.
  void derivatives(const LaneVector& x, LaneVector& gradient, LaneVector& t1, LaneVector& t2) const {
    const LaneVector w = product(inverse_axes_, R_.transposed_times(x));
    const LaneNorm::Curved at = norm_.curved(magnitudes(w));
    const LaneVector scale = signed_like(inverse_axes_, w);
    gradient = R_ * product(at.gradient, scale);
    t1 = R_ * product(at.across, scale);
    t2 = R_ * product(at.along, scale);
  }

 private:
  NormBodies(const LaneVector& axes, const LaneRotation& R, Lanes e1, Lanes e2)
      : axes_(axes),
        inverse_axes_{1 / axes.x, 1 / axes.y, 1 / axes.z},
        R_(R),
        e1_(e1),
        e2_(e2),
        norm_(2 / e1, 2 / e2),
        dual_(2 / (2 - e1), 2 / (2 - e2)) {}

  static LaneVector product(const LaneVector& u, const LaneVector& v) { return {u.x * v.x, u.y * v.y, u.z * v.z}; }
  static LaneVector magnitudes(const LaneVector& v) { return {abs(v.x), abs(v.y), abs(v.z)}; }
  static LaneVector signed_like(const LaneVector& size, const LaneVector& sign) {
    return {with_sign(size.x, sign.x), with_sign(size.y, sign.y), with_sign(size.z, sign.z)};
  }
  LaneVector in_norm(const Eigen::Vector3d& n) const {
    return product(axes_, R_.transposed_times(LaneVector::of(n, -n)));
  }

  /// The tangent (A, B) of a plane norm, q < 2, at (x, y)/N or, where one of them is below `floor`, with that one
  /// raised.
  struct Weights {
    Lanes a, b;
  };
  static Weights raised_weights(Lanes q, Lanes x, Lanes y, Lanes floor);
  static Lanes floor_for(Lanes q, Lanes allowance);

  LaneVector axes_;
  LaneVector inverse_axes_;
  LaneRotation R_;
  Lanes e1_, e2_;
  LaneNorm norm_;  ///< of x/a
  LaneNorm dual_;  ///< of a n
};

/// x^e for positive x.
inline Lanes power(Lanes x, Lanes e) {
  return exp(e * log(x));
}

/// N at (U, V)/N raises the norm by about T^q (1/q - 1/2): T for which that is the allowance.
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

inline NormBodies::Majorant NormBodies::majorant(const Support& s, double allowance) const {
  const Lanes two = both(2);
  const Lanes q1 = dual_.outer().exponent();
  const Lanes q2 = dual_.inner().exponent();
  const LaneBits inner_flat = below(q2, two);
  const LaneBits outer_flat = below(q1, two);
  const Lanes h = s.outer.norm;
  const Lanes least = 1e-30 * h;  // n along body z: rho = 0
  const Lanes rho = select(below(s.inner.norm, least), least, s.inner.norm);
  const Lanes x0 = s.w.x / rho;
  const Lanes x1 = s.w.y / rho;
  const Lanes rh = rho / h;
  const Lanes zh = s.w.z / h;
  const Lanes relative = allowance / h;
  Majorant m;

  // Q_i, and R2 = sum Q_i w_i^2 for q2 < 2: rho^2 or a little more.
  const Lanes T2 = floor_for(select(inner_flat, q2, both(1.5)), relative);
  const LaneBits raise_inner = inner_flat & (below(x0, T2) | below(x1, T2));
  Weights Q{s.inner.du / x0, s.inner.dv / x1};
  Lanes R2 = rho * rho;
  Lanes inner_x = rho * s.inner.du;  // half the derivative of rho'^2
  Lanes inner_y = rho * s.inner.dv;
  if (any(raise_inner)) {
    const Weights raised = raised_weights(select(inner_flat, q2, both(1.5)), x0, x1, T2);
    Q = {select(raise_inner, raised.a, Q.a), select(raise_inner, raised.b, Q.b)};
    const Lanes larger = Q.a * s.w.x * s.w.x + Q.b * s.w.y * s.w.y;
    R2 = select(raise_inner & below(R2, larger), larger, R2);
    inner_x = select(raise_inner, Q.a * s.w.x, inner_x);
    inner_y = select(raise_inner, Q.b * s.w.y, inner_y);
  }
  const Lanes curved = q2 - 1;
  Q = {select(inner_flat, Q.a, curved), select(inner_flat, Q.b, curved)};

  // q1 <= 2: h'^2 <= A rho'^2 + B w2'^2.
  const Lanes T1 = floor_for(select(outer_flat, q1, both(1.5)), relative);
  const LaneBits raise_outer = outer_flat & (below(rh, T1) | below(zh, T1));
  Weights A{s.outer.du / rh, s.outer.dv / zh};
  if (any(raise_outer)) {
    const Weights raised = raised_weights(select(outer_flat, q1, both(1.5)), rh, zh, T1);
    A = {select(raise_outer, raised.a, A.a), select(raise_outer, raised.b, A.b)};
  }
  const Lanes outer2 = A.a * R2 + A.b * s.w.z * s.w.z;
  const Lanes E = sqrt(select(below(h * h, outer2), outer2, h * h));

  // q1 > 2.
  const Lanes rt = sqrt(R2);
  const Lanes f = select(inner_flat, power(two, 2 / q2 - 1), both(1));
  const Lanes k = q1 - 1;
  const Lanes u = h * s.outer.du / rt;

  const LaneVector axes2 = product(axes_, axes_);
  m.D2.x = axes2.x * select(outer_flat, A.a * Q.a, u * Q.a + k * f);
  m.D2.y = axes2.y * select(outer_flat, A.a * Q.b, u * Q.b + k * f);
  m.D2.z = axes2.z * select(outer_flat, A.b, k);
  m.height = select(outer_flat, E, h);
  m.offset = select(outer_flat, E - h, s.outer.du * (rt - rho));
  const LaneVector gradient{select(outer_flat, A.a * inner_x / E, s.outer.du * inner_x / rt),
                            select(outer_flat, A.a * inner_y / E, s.outer.du * inner_y / rt),
                            select(outer_flat, A.b * s.w.z / E, s.outer.dv)};
  m.gradient = R_ * product(gradient, s.scale);
  m.raised = any(raise_inner | raise_outer);
  return m;
}

}  // namespace geom::internal
