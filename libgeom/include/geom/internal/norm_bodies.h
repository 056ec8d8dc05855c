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
  };

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
      static_cast<Value&>(at) = (*this)(w);
      return at;
    }
    LanePlaneNorm::Value inner, outer;
    evaluate(w, inner, outer);
    const Lanes k_inner = sqrt(outer.du * inner_.curvature(inner, w.x, w.y));
    const Lanes k_outer = sqrt(outer_.curvature(outer, inner.norm, w.z));
    return {value(inner, outer),
            {k_inner * w.y, -k_inner * w.x, both(0)},
            {k_outer * w.z * inner.du, k_outer * w.z * inner.dv, -k_outer * inner.norm}};
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

  /// Heights, points and the Hessians of the support functions, t1 t1^T + t2 t2^T.
  struct Support {
    Lanes height;
    LaneVector point;
    LaneVector t1, t2;
  };

  /// Of A at n and of B at -n, n a unit vector.
  Support support(const Eigen::Vector3d& n) const {
    const LaneVector v = in_norm(n);
    const LaneNorm::Curved at = dual_.curved(magnitudes(v));
    const LaneVector scale = signed_like(axes_, v);
    return {at.norm, R_ * product(at.gradient, scale), R_ * product(at.across, scale), R_ * product(at.along, scale)};
  }
  Lanes heights(const LaneVector& n) const { return dual_(magnitudes(product(axes_, R_.transposed_times(n)))).norm; }

  /// The outward normals of the surfaces at x, or at the surface points in their direction: N is homogeneous.
  LaneVector normals(const LaneVector& x) const {
    const LaneVector w = product(inverse_axes_, R_.transposed_times(x));
    return normalized(R_ * product(norm_(magnitudes(w)).gradient, signed_like(inverse_axes_, w)));
  }
  LaneVector on_surface(const LaneVector& x) const {
    return (1 / norm_(magnitudes(product(inverse_axes_, R_.transposed_times(x)))).norm) * x;
  }
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

  LaneVector axes_;
  LaneVector inverse_axes_;
  LaneRotation R_;
  Lanes e1_, e2_;
  LaneNorm norm_;  ///< of x/a
  LaneNorm dual_;  ///< of a n
};

}  // namespace geom::internal
