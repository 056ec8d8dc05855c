#pragma once

/// Exact free motion of a body of revolution: all that a contact search needs of it, and the whole state.
///
/// Torque-free, the axis u turns uniformly about the angular momentum L at Omega = |L| / I_perp:
///
///     u(t) = e0 + cos(Omega t) e1 + sin(Omega t) e2,   e0 = (u.l) l,  e1 = u - e0,  e2 = l x u,   l = L / |L|.
///
/// Without spin about the axis, L is across u and e0 = 0.

#include "base/archive.h"
#include "base/sincos.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace ed::internal {

/// What the contact search reads: position and axis as functions of time.
struct AxisMotion {
  Eigen::Vector3d position;  ///< at `time`
  Eigen::Vector3d velocity;
  Eigen::Vector3d e1;
  Eigen::Vector3d e2;
  double rate;  ///< Omega
  double time;
  Eigen::Vector3d e0;  ///< zero for bodies without spin; the last, so that nothing of theirs stands after it

  Eigen::Vector3d axis() const { return e0 + e1; }
  Eigen::Vector3d axis_at(double t) const {
    const SinCos sc = sincos(rate * (t - time));
    return e0 + sc.cos * e1 + sc.sin * e2;
  }
  Eigen::Vector3d position_at(double t) const { return position + (t - time) * velocity; }
  /// A bound of |du/dt|, 0 if the axis stands still.
  double axis_rate() const { return e2.isZero(0) ? 0 : rate; }
};

/// Principal moments of a body of revolution, and whether it may spin about its axis.
struct UniaxialInertia {
  double mass = 1;
  double perpendicular = 1;  ///< I_perp, about the axes across u
  double axial = 0;          ///< I_3, about u; used only if `spins`
  bool spins = false;        ///< false: omega is across u and stays so (the paper's bodies)
};

/// What is needed beyond the axis: the orientation about it, and the integrals of the angular velocity.
struct BodyFrame {
  Eigen::Vector3d x_axis;        ///< body x, across u, at AxisMotion::time
  Eigen::Vector3d momentum_dir;  ///< l
  double spin = 0;               ///< omega.u, conserved
  /// Integral of omega - (omega.u) u, world frame: the paper's Delta Phi, spin excluded.
  Eigen::Vector3d phi_lab = Eigen::Vector3d::Zero();
  /// The same accumulated in the body's own frame, components along body x and y.
  Eigen::Vector2d phi_body = Eigen::Vector2d::Zero();
};

template <class Archive, Is<AxisMotion> T>
void fields(Archive& archive, T& m) {
  archive(m.position, m.velocity, m.e0, m.e1, m.e2, m.rate, m.time);
  expect(archive, (m.position + m.velocity + m.e0 + m.e1 + m.e2).allFinite() && std::isfinite(m.rate + m.time),
         "a motion is not finite");
}

template <class Archive, Is<BodyFrame> T>
void fields(Archive& archive, T& frame) {
  archive(frame.x_axis, frame.momentum_dir, frame.spin, frame.phi_lab, frame.phi_body);
  expect(archive, (frame.x_axis + frame.momentum_dir + frame.phi_lab).allFinite() && frame.phi_body.allFinite(),
         "an orientation is not finite");
}

/// v, which is a unit vector but for rounding, and squares of what it is off, with its length corrected.
///
/// Not v / sqrt(|v|^2): 1 + 2^-52 has the root 1, so that vectors would stay too long, but not too short, and what they
/// turn would gain energy with every collision.
inline Eigen::Vector3d renormalized(const Eigen::Vector3d& v) {
  return v + (0.5 * (1 - v.squaredNorm())) * v;
}

/// The part of omega across the axis; its length is constant during flight.
inline Eigen::Vector3d omega_across(const AxisMotion& m) {
  return m.rate * (m.e0 + m.e1).cross(m.e2);
}

/// Sets the rotation from the axis u (unit) and the angular velocity across it; frame.spin is kept.
void set_rotation(const UniaxialInertia& inertia, const Eigen::Vector3d& u, const Eigen::Vector3d& omega,
                  AxisMotion& motion, BodyFrame& frame);

/// Moves a body to time t, exactly, and lets the integrals of omega grow.
void advance(const UniaxialInertia& inertia, double t, AxisMotion& motion, BodyFrame& frame);

}  // namespace ed::internal
