#pragma once

/// Bodies in motion without rounding (quad.h): the ones that the numbers of libed's motions describe.

#include <common/quad.h>

#include <axis_motion.h>

#include <Eigen/Core>

#include <array>

namespace quad {

/// An ellipsoid of revolution whose axis turns as AxisMotion says, with its vectors made exactly orthonormal.
class ExactSpheroid {
 public:
  ExactSpheroid(double a, double b, const ed::internal::AxisMotion& m)
      : b2_(static_cast<Quad>(b) * b), c_(static_cast<Quad>(a) * a - b2_), rate_(m.rate), time_(m.time) {
    const Quad3 l = unit(Quad3(m.e1).cross(Quad3(m.e2)));
    const Quad along = Quad3(m.e0).dot(l);
    const Quad3 e1(m.e1);
    e0_ = along * l;
    e1_ = sqrt(1 - along * along) * unit(e1 - e1.dot(l) * l);
    e2_ = l.cross(e1_);
  }

  Quad height(Quad t, const Quad3& n) const {
    const SinCos sc = sincos(rate_ * (t - time_));
    const Quad x = n.dot(e0_ + sc.cos * e1_ + sc.sin * e2_);
    return sqrt(b2_ + c_ * x * x);
  }

 private:
  Quad b2_, c_, rate_, time_;
  Quad3 e0_, e1_, e2_;
};

/// Free rotation of a body whose first two moments agree (Landau and Lifshitz, Mechanics, sec. 33).
class ExactTop {
 public:
  ExactTop(const Eigen::Vector3d& inertia, const Eigen::Matrix3d& R, const Eigen::Vector3d& omega, double time)
      : time_(time) {
    z_ = unit(Quad3(Eigen::Vector3d(R.col(2))));
    const Quad3 x(Eigen::Vector3d(R.col(0)));
    x_ = unit(x - x.dot(z_) * z_);
    const Quad3 w(omega);
    const Quad spin = w.dot(z_);
    const Quad ratio = static_cast<Quad>(inertia.z()) / inertia.x();
    const Quad3 turning = w + ((ratio - 1) * spin) * z_;
    precession_ = turning.norm();
    l_ = unit(turning);
    own_ = spin * (1 - ratio);
  }

  /// n in the body's axes.
  std::array<Quad, 3> seen(Quad t, const Quad3& n) const {
    const Quad tau = t - time_;
    const Quad3 z = turned(z_, l_, precession_ * tau);
    const Quad3 x = turned(turned(x_, z_, own_ * tau), l_, precession_ * tau);
    return {n.dot(x), n.dot(z.cross(x)), n.dot(z)};
  }

 private:
  Quad time_, precession_, own_;
  Quad3 x_, z_, l_;
};

/// A superellipsoid with exponents e1, e2 of 0.5, 1 or 1.5, whose dual exponents 2 / (2 - e), 4/3, 2 and 4, need only
/// roots.
class ExactSuperellipsoid {
 public:
  ExactSuperellipsoid(const Eigen::Vector3d& semi_axes, double e1, double e2, const ExactTop& top)
      : axes_(semi_axes), e1_(e1), e2_(e2), top_(top) {}

  Quad height(Quad t, const Quad3& n) const {
    const auto m = top_.seen(t, n);
    return norm(e1_, norm(e2_, axes_.x * abs(m[0]), axes_.y * abs(m[1])), axes_.z * abs(m[2]));
  }

 private:
  static Quad norm(double e, Quad x, Quad y) {
    if (e == 1) return sqrt(x * x + y * y);
    if (e > 1) return sqrt(sqrt(x * x * x * x + y * y * y * y));
    const Quad s = sqrt(x * cbrt(x) + y * cbrt(y));
    return s * sqrt(s);
  }

  Quad3 axes_;
  double e1_, e2_;
  ExactTop top_;
};

class ExactSpherocylinder {
 public:
  ExactSpherocylinder(double half_length, double radius, const ExactTop& top)
      : half_length_(half_length), radius_(radius), top_(top) {}
  Quad height(Quad t, const Quad3& n) const { return radius_ + half_length_ * abs(top_.seen(t, n)[2]); }

 private:
  Quad half_length_, radius_;
  ExactTop top_;
};

/// Uniform motion of a centre.
struct ExactPath {
  Quad3 position, velocity;
  Quad time;

  template <class Motion>
  static ExactPath of(const Motion& m) {
    return {Quad3(m.position), Quad3(m.velocity), m.time};
  }
  Quad3 at(Quad t) const { return position + (t - time) * velocity; }
};

/// Two bodies; B moved by whole boxes.
template <class Body>
struct ExactPair {
  Body a, b;
  ExactPath path_a, path_b;
  Quad3 shift;

  /// The gap along n / |n|.
  Quad gap(Quad t, const Eigen::Vector3d& normal) const {
    const Quad3 n = unit(Quad3(normal));
    return n.dot(path_b.at(t) + shift - path_a.at(t)) - a.height(t, n) - b.height(t, Quad(-1) * n);
  }
};

}  // namespace quad
