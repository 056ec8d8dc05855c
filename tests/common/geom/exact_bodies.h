#pragma once

/// Bodies in motion without rounding (quad.h): exactly those that the numbers of libed's motions describe.

#include <common/quad.h>

#include <motion/axis_motion.h>

#include <Eigen/Core>

#include <array>
#include <cmath>

namespace quad {

/// Ellipsoid of revolution whose axis moves according to an AxisMotion, with its vectors made exactly orthonormal.
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
class ExactSymmetricTop {
 public:
  ExactSymmetricTop(const Eigen::Vector3d& inertia, const Eigen::Matrix3d& R, const Eigen::Vector3d& omega, double time)
      : time_(time) {
    z_ = unit(Quad3(Eigen::Vector3d(R.col(2))));
    const Quad3 x(Eigen::Vector3d(R.col(0)));
    x_ = unit(x - x.dot(z_) * z_);
    const Quad3 w(omega);
    const Quad spin = w.dot(z_);
    const Quad ratio = static_cast<Quad>(inertia.z()) / inertia.x();
    const Quad3 precession = w + ((ratio - 1) * spin) * z_;
    precession_ = precession.norm();
    l_ = unit(precession);
    own_ = spin * (1 - ratio);
  }

  /// Returns n in the body's axes.
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

/// Free rotation of a body with any moments: Euler's equations and those of its axes by their Taylor series, a quarter
/// of a radian a step, with a truncation error below 1e-30.
class ExactAsymmetricTop {
 public:
  ExactAsymmetricTop(const Eigen::Vector3d& inertia, const Eigen::Matrix3d& R, const Eigen::Vector3d& omega,
                     double time)
      : time_(time) {
    const Quad3 z = unit(Quad3(Eigen::Vector3d(R.col(2))));
    const Quad3 x(Eigen::Vector3d(R.col(0)));
    axes_[2] = z;
    axes_[0] = unit(x - x.dot(z) * z);
    axes_[1] = z.cross(axes_[0]);
    const Quad3 w(omega);
    for (int k = 0; k < 3; ++k) {
      rates_[k] = w.dot(axes_[k]);
      const Quad next = inertia[(k + 1) % 3];
      coupling_[k] = (next - inertia[(k + 2) % 3]) / inertia[k];
    }
    const double fastest = omega.norm() * std::sqrt(inertia.maxCoeff() / inertia.minCoeff());
    longest_ = fastest > 0 ? 0.25 / fastest : 1e300;
  }

  /// Returns n in the body's axes.
  std::array<Quad, 3> seen(Quad t, const Quad3& n) const {
    go_to(t);
    return {n.dot(axes_[0]), n.dot(axes_[1]), n.dot(axes_[2])};
  }

 private:
  static constexpr int kOrder = 44;

  /// Integrates from the time of the last call.
  void go_to(Quad t) const {
    while (time_ != t) {
      const Quad left = t - time_;
      if (abs(left) <= longest_) {
        step(left);
        time_ = t;
      } else {
        const Quad one = left > 0 ? Quad(longest_) : Quad(-longest_);
        step(one);
        time_ = time_ + one;
      }
    }
  }

  void step(Quad h) const {
    std::array<std::array<Quad, 3>, kOrder + 1> w{};
    std::array<std::array<Quad3, 3>, kOrder + 1> e{};
    w[0] = rates_;
    e[0] = axes_;
    for (int n = 0; n < kOrder; ++n) {
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        const int m = (k + 2) % 3;
        Quad product = 0;
        Quad3 turn;  // omega x e_k = omega_m e_l - omega_l e_m
        for (int j = 0; j <= n; ++j) {
          product += w[j][l] * w[n - j][m];
          turn = turn + (w[j][m] * e[n - j][l] - w[j][l] * e[n - j][m]);
        }
        w[n + 1][k] = coupling_[k] * product / (n + 1);
        e[n + 1][k] = (Quad(1) / (n + 1)) * turn;
      }
    }
    for (int k = 0; k < 3; ++k) {
      Quad rate = 0;
      Quad3 axis;
      for (int n = kOrder; n >= 0; --n) {
        rate = rate * h + w[n][k];
        axis = h * axis + e[n][k];
      }
      rates_[k] = rate;
      axes_[k] = axis;
    }
  }

  mutable Quad time_;
  mutable std::array<Quad, 3> rates_;  ///< rates about the body's axes
  mutable std::array<Quad3, 3> axes_;
  std::array<Quad, 3> coupling_;
  double longest_;  ///< longest step
};

/// Superellipsoid with any exponents; only roots are needed if the dual exponents, 2 / (2 - e), allow it.
template <class Top>
class ExactSuperellipsoid {
 public:
  ExactSuperellipsoid(const Eigen::Vector3d& semi_axes, double e1, double e2, const Top& top)
      : axes_(semi_axes), e1_(e1), e2_(e2), top_(top) {}

  Quad height(Quad t, const Quad3& n) const {
    const auto m = top_.seen(t, n);
    return norm(e1_, norm(e2_, axes_.x * abs(m[0]), axes_.y * abs(m[1])), axes_.z * abs(m[2]));
  }

 private:
  static Quad norm(double e, Quad x, Quad y) {
    if (e == 1) return sqrt(x * x + y * y);
    if (e == 1.5) return sqrt(sqrt(x * x * x * x + y * y * y * y));
    if (e == 0.5) {
      const Quad s = sqrt(x * cbrt(x) + y * cbrt(y));
      return s * sqrt(s);
    }
    const Quad dual = 2 / (2 - static_cast<Quad>(e));
    return pow(pow(x, dual) + pow(y, dual), 1 / dual);
  }

  Quad3 axes_;
  double e1_, e2_;
  Top top_;
};

class ExactSpherocylinder {
 public:
  ExactSpherocylinder(double half_length, double radius, const ExactSymmetricTop& top)
      : half_length_(half_length), radius_(radius), top_(top) {}
  Quad height(Quad t, const Quad3& n) const { return radius_ + half_length_ * abs(top_.seen(t, n)[2]); }

 private:
  Quad half_length_, radius_;
  ExactSymmetricTop top_;
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

/// Pair of bodies; B is moved by whole boxes.
template <class Body>
struct ExactPair {
  Body a, b;
  ExactPath path_a, path_b;
  Quad3 shift;

  /// Returns the gap along n / |n|.
  Quad gap(Quad t, const Eigen::Vector3d& normal) const {
    const Quad3 n = unit(Quad3(normal));
    return n.dot(path_b.at(t) + shift - path_a.at(t)) - a.height(t, n) - b.height(t, Quad(-1) * n);
  }
};

}  // namespace quad
