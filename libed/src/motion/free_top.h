#pragma once

/// Exact free rotation of any rigid body about its centre of mass: constants are computed once a flight, then the state
/// at any time.
///
/// Notation: I1, I2, I3 principal moments; L = R I R^T omega the angular momentum, constant in the world; l = L / |L|;
/// E the kinetic energy of rotation. The kind is determined by the moments alone, exactly equal or not: a tolerance
/// would gain nothing, because an asymmetric top's formulas are as accurate for moments that nearly agree.
///
/// - Spherical top (three equal moments), or omega along a principal axis, or no rotation: omega is constant.
/// - Symmetric top (two equal moments I_perp, about any body axis u): with Omega = |L| / I_perp and k = (omega.u) (1 -
///   I_3 / I_perp), R(tau) = Rot(l, Omega tau) R(0) Rot(e_u, k tau) and omega = Omega l + k u(tau) (Landau and
///   Lifshitz, Mechanics, sec. 33 and 35).
/// - Asymmetric top: elliptic functions, see asymmetric_top.h.
///
/// Determinism: +, -, *, / and sqrt, libed's own sine, cosine and exponential, and exact functions of the C library
/// (nearbyint, remainder, frexp). Eigen's matrix products and sums are avoided, because their order, and whether they
/// fuse multiplications and additions, depends on the instruction set they are compiled for.

#include "motion/asymmetric_top.h"
#include "motion/top_state.h"

#include <Eigen/Core>

#include <array>
#include <variant>

namespace ed::internal {

/// Unit vector that rotates about another one: along + cos part + sin part of the angle.
struct RotatingAxis {
  Eigen::Vector3d along, cosine, sine;

  /// Returns the motion of `v` about the unit vector l.
  static RotatingAxis of(const Eigen::Vector3d& v, const Eigen::Vector3d& l);
  Eigen::Vector3d at(const SinCos& sc) const { return along + sc.cos * cosine + sc.sin * sine; }
};

template <class Archive, Is<RotatingAxis> T>
void fields(Archive& archive, T& axis) {
  archive(axis.along, axis.cosine, axis.sine);
}

/// Rotation with constant angular velocity.
class UniformTurn {
 public:
  UniformTurn() = default;  ///< makes an object to be read into
  UniformTurn(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& omega);
  TopState at(double tau) const { return {rotation(tau), omega_, Eigen::Vector3d::Zero()}; }
  Eigen::Matrix3d rotation(double tau) const;
  TopBounds bounds() const;
  TurnedAngles turned(double tau) const;

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.x_, self.y_, self.omega_, self.rate_);
  }

 private:
  RotatingAxis x_, y_;  ///< body axes
  Eigen::Vector3d omega_;
  double rate_;  ///< |omega|
};

/// Rotation with two equal moments, about the body axis number `axis`.
class SymmetricTop {
 public:
  SymmetricTop() = default;  ///< makes an object to be read into
  SymmetricTop(int axis, const Eigen::Vector3d& inertia, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& omega);
  TopState at(double tau) const;
  Eigen::Matrix3d rotation(double tau) const;
  TopBounds bounds() const;
  TurnedAngles turned(double tau) const;

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.axes_, self.start_, self.l_, self.precession_, self.own_, self.spin_, self.across_);
    expect(archive, are_axes(self.axes_), "the axes of a top");
  }

 private:
  TopAxes axes_at(double tau) const;

  std::array<int, 3> axes_;  ///< body axes: u and the next two in cyclic order
  TopAxes start_;            ///< axes at tau = 0
  Eigen::Vector3d l_;
  double precession_;       ///< Omega
  double own_;              ///< k
  double spin_;             ///< omega.u
  Eigen::Vector2d across_;  ///< components of omega along the axes after u at tau = 0
};

/// Free rotation about the centre of mass, constants computed once a flight.
class FreeTop {
 public:
  /// Constructs a body at rest, body axes along the world's.
  FreeTop();

  /// Computes the constants from the state at tau = 0. Moments must be positive and physically possible
  /// (check_inertia), the rotation orthonormal to 1e-8, omega in the world frame, all numbers finite (not checked).
  FreeTop(const Eigen::Vector3d& inertia, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& omega);

  /// Returns the state at tau, of either sign and any length. The error is rounding, below 2e-15 (1 + |omega| |tau|).
  /// For asymmetric tops the effect of the rounding of omega on the motion is added, which is larger near the
  /// separatrix.
  TopState at(double tau) const;
  Eigen::Matrix3d rotation(double tau) const;

  /// Upper bounds over all times: |omega|, |d omega/dt|, |d2 omega/dt2| (world frame). Each is the maximum itself,
  /// except for rounding.
  double max_omega() const { return bounds_.omega; }
  double max_alpha() const { return bounds_.alpha; }
  double max_jerk() const { return bounds_.jerk; }

  /// Returns the integrals of omega over [0, tau]. Closed form for spherical and symmetric tops. Asymmetric ones need
  /// quadrature, to rounding, 1e-15 (1 + |omega| |tau|)^2, in a time proportional to |omega| |tau|.
  TurnedAngles turned(double tau) const;

  /// Archives the constants themselves: computed again from a state they would have other last bits.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.top_, self.bounds_);
  }

 private:
  std::variant<UniformTurn, SymmetricTop, AsymmetricTop> top_;
  TopBounds bounds_;
};

}  // namespace ed::internal
