#pragma once

/// Nested norms (kernel/nested_norm.h) of two bodies at once, one to a lane.

#include <geom/kernel/lanes.h>

#include <Eigen/Core>

namespace geom::kernel {

/// Norm Nk(u, v) = (u^q + v^q)^(1/q), u, v >= 0, as in PlaneNorm, by logarithms.
///
/// With t = v/u <= 1: t^(q-1) = exp((q - 1) ln t). Its relative error, |(q - 1) ln t| epsilon, grows no faster than the
/// value falls, so that all results are exact to some epsilon of the norm.
class LanePlaneNorm {
 public:
  explicit LanePlaneNorm(Lanes q) : minus_one_(q - 1), inverse_(1 / q) {}

  Lanes exponent() const { return 1 + minus_one_; }

  struct Value {
    Lanes norm;
    Lanes du, dv;  ///< (u / N)^(q-1)
  };
  struct Logged : Value {
    Lanes log_norm;  ///< ln N
  };

  Logged operator()(Lanes u, Lanes v, Lanes log_u, Lanes log_v) const {
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
    return {{larger * root, select(swapped, d_smaller, d_larger), select(swapped, d_larger, d_smaller)},
            log_larger + log_root};
  }

  /// Returns t^(q-1) from ln t; below e^-70 for log(0).
  Lanes slope(Lanes log_t) const { return exp(minus_one_ * log_t); }
  /// Returns s^(1/q).
  Lanes root(Lanes s) const { return exp(log(s) * inverse_); }

  /// Returns l of the Hessian l (v, -u)(v, -u)^T; u, v > 0.
  Lanes curvature(const Value& at, Lanes u, Lanes v) const { return minus_one_ * (at.du * at.dv) / (u * v * at.norm); }

 private:
  Lanes minus_one_;
  Lanes inverse_;
};

class LaneNorm {
 public:
  struct Levels {
    LanePlaneNorm::Value inner, outer;
  };

  LaneNorm(Lanes q1, Lanes q2) : outer_(q1), inner_(q2), kind_(kind_of(q1, q2)) {}

  struct Value {
    Lanes norm;
    LaneVector gradient;  ///< dN/dw, each in [0, 1]
  };
  /// Value, gradient and Hessian across across^T + along along^T.
  struct Curved : Value {
    LaneVector across;  ///< vector in the plane of w0 and w1
    LaneVector along;
    Levels levels;
  };

  const LanePlaneNorm& outer() const { return outer_; }
  const LanePlaneNorm& inner() const { return inner_; }

  Value operator()(const LaneVector& w) const {
    if (kind_ == Kind::nested) return value(nested(w));
    if (kind_ == Kind::quadratic) {
      const Lanes norm = sqrt(w.dot(w));
      return {norm, (1 / norm) * w};
    }
    const Powers t = powers(w);
    const Lanes root = outer_.root(t.s);
    return {t.larger * root, (root / t.s) * t.p};
  }

  /// Returns value, gradient and Hessian. Both vectors of the Hessian are orthogonal to w to rounding. If a component
  /// of w vanishes and q < 2 (a flat face) the Hessian is infinite; it is then that of w with components kept above
  /// kLeast of the largest, which is huge.
  Curved curved(const LaneVector& w) const {
    const Lanes larger = select(below(w.x, w.y), w.y, w.x);
    const Lanes least = kLeast * select(below(larger, w.z), w.z, larger);
    const LaneBits vanishing = below(w.x, least) | below(w.y, least) | below(w.z, least);
    if (any(vanishing)) [[unlikely]] {
      const auto lifted = [&least](Lanes v) { return select(below(v, least), 2 * least, v); };
      Curved at = curved({lifted(w.x), lifted(w.y), lifted(w.z)});
      at.levels = nested(w);
      static_cast<Value&>(at) = value(at.levels);
      return at;
    }
    const Levels levels = kind_ == Kind::equal ? equal(w) : kind_ == Kind::quadratic ? quadratic(w) : nested(w);
    const auto& [inner, outer] = levels;
    const Lanes k_inner = sqrt(outer.du * inner_.curvature(inner, w.x, w.y));
    const Lanes k_outer = sqrt(outer_.curvature(outer, inner.norm, w.z));
    return {value(levels),
            {k_inner * w.y, -k_inner * w.x, both(0)},
            {k_outer * w.z * inner.du, k_outer * w.z * inner.dv, -k_outer * inner.norm},
            levels};
  }

 private:
  /// Exponents of both lanes: q1 = q2 = 2, q1 = q2, or any.
  enum class Kind { quadratic, equal, nested };
  static Kind kind_of(Lanes q1, Lanes q2) {
    if (q1[0] != q2[0] || q1[1] != q2[1]) return Kind::nested;
    return q1[0] == 2 && q1[1] == 2 ? Kind::quadratic : Kind::equal;
  }

  static constexpr double kLeast = 1e-20;

  Levels nested(const LaneVector& w) const {
    const Lanes log_z = log(w.z);
    const LanePlaneNorm::Logged inner = inner_(w.x, w.y, log(w.x), log(w.y));
    return {inner, outer_(inner.norm, w.z, inner.log_norm, log_z)};
  }

  /// Returns both levels for w > 0 by the square root of a sum of squares.
  static Levels quadratic(const LaneVector& w) {
    const Lanes xy = w.x * w.x + w.y * w.y;
    const Lanes rho = sqrt(xy);
    const Lanes norm = sqrt(xy + w.z * w.z);
    const Lanes by_rho = 1 / rho;
    const Lanes by_norm = 1 / norm;
    return {{rho, w.x * by_rho, w.y * by_rho}, {norm, rho * by_norm, w.z * by_norm}};
  }

  /// Powers for q1 = q2 = q, where no power has to wait for that of another level: N = larger s^(1/q).
  struct Powers {
    Lanes larger;   ///< largest of the three components
    LaneVector p;   ///< t^(q-1), t = w / larger
    Lanes s_xy, s;  ///< sums of t^q
  };
  Powers powers(const LaneVector& w) const {
    const LaneVector logs{log(w.x), log(w.y), log(w.z)};
    const LaneBits y_leads = below(w.x, w.y);
    const Lanes larger_xy = select(y_leads, w.y, w.x);
    const Lanes log_xy = select(y_leads, logs.y, logs.x);
    const LaneBits z_leads = below(larger_xy, w.z);
    const Lanes larger = select(z_leads, w.z, larger_xy);
    const Lanes log_larger = select(z_leads, logs.z, log_xy);
    const LaneVector p{outer_.slope(logs.x - log_larger), outer_.slope(logs.y - log_larger),
                       outer_.slope(logs.z - log_larger)};
    const Lanes zero = both(0);
    const LaneVector t = (1 / select(below(zero, larger), larger, both(1))) * w;
    const Lanes s_xy = t.x * p.x + t.y * p.y;
    return {larger, p, s_xy, s_xy + t.z * p.z};
  }

  /// Returns both levels for q1 = q2 and w > 0.
  Levels equal(const LaneVector& w) const {
    const Powers t = powers(w);
    const Lanes root_xy = outer_.root(t.s_xy);
    const Lanes root = outer_.root(t.s);
    const Lanes d_xy = root_xy / t.s_xy;
    const Lanes d = root / t.s;
    return {{t.larger * root_xy, t.p.x * d_xy, t.p.y * d_xy}, {t.larger * root, d / d_xy, t.p.z * d}};
  }

  static Value value(const Levels& levels) {
    const auto& [inner, outer] = levels;
    return {outer.norm, {outer.du * inner.du, outer.du * inner.dv, outer.dv}};
  }

  LanePlaneNorm outer_;
  LanePlaneNorm inner_;
  Kind kind_;
};

}  // namespace geom::kernel
