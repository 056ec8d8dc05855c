#pragma once

/// Nested norm N(w) = N1(N2(w0, w1), w2), Nk(u, v) = (u^qk + v^qk)^(1/qk), w >= 0. Its unit ball is a superellipsoid
/// (with qk = 2/ek), and its dual, of the same kind with qk = 2/(2 - ek), is the support function (Hoelder).

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace geom::kernel {

/// Power x^e for x >= 0 and one e > 0: by products, square and cube roots for e = 1/4, 1/3, 1/2, 2/3, 1 to 5/2 by
/// halves, 3, 7/2, 4, else by std::pow. Fifths, as 1/q of q = 5/2 and 5 (e = 1.2 and 1.6), would gain nothing, because
/// a fifth root is a pow. Distances use this class only for values and gradients: the kernels have both bodies' powers
/// in one vector (lanes.h).
class Power {
 public:
  explicit Power(double exponent) : exponent_(exponent), kind_(kind_of(exponent)) {}

  double operator()(double x) const {
    switch (kind_) {
      case Kind::one:
        return x;
      case Kind::two:
        return x * x;
      case Kind::three:
        return x * x * x;
      case Kind::four:
        return (x * x) * (x * x);
      case Kind::half:
        return std::sqrt(x);
      case Kind::quarter:
        return std::sqrt(std::sqrt(x));
      case Kind::three_halves:
        return x * std::sqrt(x);
      case Kind::five_halves:
        return x * x * std::sqrt(x);
      case Kind::seven_halves:
        return x * x * x * std::sqrt(x);
      case Kind::third:
        return std::cbrt(x);
      case Kind::two_thirds: {
        const double root = std::cbrt(x);
        return root * root;
      }
      case Kind::general:
        break;
    }
    return std::pow(x, exponent_);
  }

 private:
  enum class Kind {
    one,
    two,
    three,
    four,
    half,
    quarter,
    three_halves,
    five_halves,
    seven_halves,
    third,
    two_thirds,
    general
  };

  static Kind kind_of(double e) {
    const auto is = [e](double value) { return std::abs(e - value) < 4e-16 * value; };
    if (is(1)) return Kind::one;
    if (is(2)) return Kind::two;
    if (is(3)) return Kind::three;
    if (is(4)) return Kind::four;
    if (is(0.5)) return Kind::half;
    if (is(0.25)) return Kind::quarter;
    if (is(1.5)) return Kind::three_halves;
    if (is(2.5)) return Kind::five_halves;
    if (is(3.5)) return Kind::seven_halves;
    if (is(1.0 / 3)) return Kind::third;
    if (is(2.0 / 3)) return Kind::two_thirds;
    return Kind::general;
  }

  double exponent_;
  Kind kind_;
};

/// Norm N(u, v) = (u^q + v^q)^(1/q) for u, v >= 0, and its derivatives.
class PlaneNorm {
 public:
  explicit PlaneNorm(double q) : q_(q), power_(q - 1), root_(1 / q) {}

  struct Value {
    double norm;
    double du;  ///< (u / N)^(q-1)
    double dv;
  };

  Value operator()(double u, double v) const {
    const bool swapped = v > u;
    const double larger = swapped ? v : u;
    const double smaller = swapped ? u : v;
    if (!(larger > 0)) return {0, 0, 0};
    const double t = smaller / larger;
    const double p = power_(t);  // t^(q-1)
    const double s = 1 + t * p;
    const double root = root_(s);
    const double d_larger = root / s;  // s^(1/q - 1)
    const double d_smaller = p * d_larger;
    return swapped ? Value{larger * root, d_smaller, d_larger} : Value{larger * root, d_larger, d_smaller};
  }

  /// Returns l of the Hessian l (v, -u)(v, -u)^T; u, v > 0.
  double curvature(const Value& at, double u, double v) const { return (q_ - 1) * (at.du / u) * (at.dv / v) / at.norm; }

 private:
  double q_;
  Power power_;
  Power root_;
};

class NestedNorm {
 public:
  NestedNorm(double q1, double q2) : outer_(q1), inner_(q2) {}

  struct Value {
    double norm;
    Eigen::Vector3d gradient;  ///< dN/dw, each in [0, 1]
  };

  Value operator()(const Eigen::Vector3d& w) const {
    const PlaneNorm::Value inner = inner_(w.x(), w.y());
    const PlaneNorm::Value outer = outer_(inner.norm, w.z());
    return {outer.norm, {outer.du * inner.du, outer.du * inner.dv, outer.dv}};
  }

  /// Value, gradient and Hessian across across^T + along along^T.
  struct Curved : Value {
    Eigen::Vector3d across;  ///< vector in the plane of w0 and w1
    Eigen::Vector3d along;
  };

  /// Returns value, gradient and Hessian from one evaluation of either plane's norm. Both vectors of the Hessian are
  /// orthogonal to w to rounding. If a component of w vanishes and q < 2 (a flat face) the Hessian is infinite; it is
  /// then that of w with components kept above kLeast of the largest, which is huge.
  Curved curved(const Eigen::Vector3d& w) const {
    const double least = kLeast * w.maxCoeff();
    if (w.minCoeff() < least) [[unlikely]] {
      Curved at = curved(w.cwiseMax(2 * least));
      static_cast<Value&>(at) = (*this)(w);
      return at;
    }
    const PlaneNorm::Value inner = inner_(w.x(), w.y());
    const PlaneNorm::Value outer = outer_(inner.norm, w.z());
    const double k_inner = std::sqrt(outer.du * inner_.curvature(inner, w.x(), w.y()));
    const double k_outer = std::sqrt(outer_.curvature(outer, inner.norm, w.z()));
    return {{outer.norm, {outer.du * inner.du, outer.du * inner.dv, outer.dv}},
            {k_inner * w.y(), -k_inner * w.x(), 0},
            {k_outer * w.z() * inner.du, k_outer * w.z() * inner.dv, -k_outer * inner.norm}};
  }

  Eigen::Matrix3d hessian(const Eigen::Vector3d& w) const {
    const Curved at = curved(w);
    return at.across * at.across.transpose() + at.along * at.along.transpose();
  }

 private:
  static constexpr double kLeast = 1e-20;

  PlaneNorm outer_;
  PlaneNorm inner_;
};

}  // namespace geom::kernel
