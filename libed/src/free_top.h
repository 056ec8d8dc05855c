#pragma once

/// Exact free rotation of any rigid body about its centre of mass, for one flight: constants once, then any time.
///
/// Notation: I1, I2, I3 principal moments; L = R I R^T omega the angular momentum, constant in the world; l = L / |L|;
/// E the kinetic energy of rotation.
///
/// Spherical top (three equal moments), or omega along a principal axis, or no rotation: omega is constant.
///
/// Symmetric top (two equal moments I_perp, about any body axis u): with Omega = |L| / I_perp and
/// k = (omega.u) (1 - I_3 / I_perp), R(tau) = Rot(l, Omega tau) R(0) Rot(e_u, k tau) and omega = Omega l + k u(tau)
/// (Landau and Lifshitz, Mechanics, sec. 33, 35).
///
/// Determinism: +, -, *, / and sqrt, libed's own sine and cosine, and exact functions of the C library (remainder).

#include <Eigen/Core>

#include <variant>

namespace ed::internal {

/// Rotation at an instant.
struct TopState {
  Eigen::Matrix3d R;      ///< body to world, orthonormal to 1e-15
  Eigen::Vector3d omega;  ///< world frame
  Eigen::Vector3d alpha;  ///< d omega / dt, world frame
};

/// Upper bounds over all times.
struct TopBounds {
  double omega = 0;  ///< of |omega|
  double alpha = 0;  ///< of |d omega/dt|
  double jerk = 0;   ///< of |d2 omega/dt2|, world frame
};

/// Constant angular velocity.
class UniformTurn {
 public:
  UniformTurn(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& omega);
  TopState at(double tau) const;
  Eigen::Matrix3d rotation(double tau) const;
  TopBounds bounds() const;
  Eigen::Vector3d turned_world(double tau) const;
  Eigen::Vector3d turned_body(double tau) const;

 private:
  Eigen::Matrix3d start_;
  Eigen::Vector3d omega_;
  Eigen::Vector3d direction_;  ///< of omega; any unit vector without rotation
  double rate_;                ///< |omega|
};

/// Two equal moments, about the body axis number `axis`.
class SymmetricTop {
 public:
  SymmetricTop(int axis, const Eigen::Vector3d& inertia, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& omega);
  TopState at(double tau) const;
  Eigen::Matrix3d rotation(double tau) const;
  TopBounds bounds() const;
  Eigen::Vector3d turned_world(double tau) const;
  Eigen::Vector3d turned_body(double tau) const;

 private:
  int axis_;
  Eigen::Vector3d u_;  ///< the body's axis at tau = 0
  Eigen::Vector3d x_;  ///< the next body axis in cyclic order at tau = 0
  Eigen::Vector3d y_;  ///< the one after
  Eigen::Vector3d l_;
  double precession_;       ///< Omega
  double own_;              ///< k
  double spin_;             ///< omega.u
  Eigen::Vector2d across_;  ///< omega along x and y at tau = 0
};

/// Free rotation about the centre of mass, constants computed once a flight.
class FreeTop {
 public:
  /// At rest, body axes along the world's.
  FreeTop();

  /// The state at tau = 0. Moments positive and such as a body can have (check_inertia), rotation orthonormal, omega in
  /// the world frame; numbers finite. Throws std::invalid_argument for three different moments (not available yet).
  FreeTop(const Eigen::Vector3d& inertia, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& omega);

  /// The state at tau, of either sign and any length. Error: rounding, some 1e-16 (1 + |omega| |tau|).
  TopState at(double tau) const;
  Eigen::Matrix3d rotation(double tau) const;

  /// Upper bounds over all times: |omega|, |d omega/dt|, |d2 omega/dt2| (world frame). Each is the maximum itself, but
  /// for rounding.
  double max_omega() const { return bounds_.omega; }
  double max_alpha() const { return bounds_.alpha; }
  double max_jerk() const { return bounds_.jerk; }

  /// Integral of omega over [0, tau], world frame.
  Eigen::Vector3d turned_world(double tau) const;

  /// Integral of the components of omega along the body's axes over [0, tau]: what rotational diffusion in the body
  /// frame is made of.
  Eigen::Vector3d turned_body(double tau) const;

 private:
  std::variant<UniformTurn, SymmetricTop> top_;
  TopBounds bounds_;
};

}  // namespace ed::internal
