#pragma once

/// Exact free motion of a body of revolution: the part that a contact search needs, and the whole state.
///
/// Without torque, the axis u rotates uniformly about the angular momentum L at Omega = |L| / I_perp:
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

/// Position and axis as functions of time: the data that a contact search reads.
struct AxisMotion {
  Eigen::Vector3d position;  ///< position at `time`
  Eigen::Vector3d velocity;
  Eigen::Vector3d e1;
  Eigen::Vector3d e2;
  double rate;  ///< Omega
  double time;
  Eigen::Vector3d e0;  ///< zero for bodies without spin; the last member, so that no data of such bodies follows it

  Eigen::Vector3d axis() const { return e0 + e1; }
  Eigen::Vector3d axis_at(double t) const {
    const SinCos sc = sincos(rate * (t - time));
    return e0 + sc.cos * e1 + sc.sin * e2;
  }
  Eigen::Vector3d position_at(double t) const { return position + (t - time) * velocity; }
  /// Returns a bound of |du/dt|, 0 if the axis does not move.
  double axis_rate() const { return e2.isZero(0) ? 0 : rate; }
};

/// Principal moments of a body of revolution, and whether it may spin about its axis.
struct UniaxialInertia {
  double mass = 1;
  double perpendicular = 1;  ///< I_perp, about the axes across u
  double axial = 0;          ///< I_3, about u; used only if `spins`
  bool spins = false;        ///< false: omega is across u and remains so (the paper's bodies)
};

/// Part of the state beyond the axis: the orientation about it, and the integrals of the angular velocity.
struct BodyFrame {
  Eigen::Vector3d x_axis;        ///< body x, across u, at AxisMotion::time
  Eigen::Vector3d momentum_dir;  ///< l
  double spin = 0;               ///< omega.u, conserved
  /// Integral of omega - (omega.u) u, world frame: the paper's Delta Phi, spin excluded.
  Eigen::Vector3d phi_lab = Eigen::Vector3d::Zero();
  /// Integral of omega in the body's own frame, components along body x and y.
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

/// Returns v, a unit vector except for rounding, with its length corrected to first order in the deviation.
///
/// v / sqrt(|v|^2) is not used: 1 + 2^-52 has the root 1, so that vectors that are too long would remain so, but not
/// those that are too short, and bodies would gain energy with every collision.
inline Eigen::Vector3d renormalized(const Eigen::Vector3d& v) {
  return v + (0.5 * (1 - v.squaredNorm())) * v;
}

/// Returns the part of omega across the axis; its length is constant during flight.
inline Eigen::Vector3d omega_across(const AxisMotion& m) {
  return m.rate * (m.e0 + m.e1).cross(m.e2);
}

/// Sets the rotation from the axis u (unit) and the angular velocity across it; frame.spin is kept.
void set_rotation(const UniaxialInertia& inertia, const Eigen::Vector3d& u, const Eigen::Vector3d& omega,
                  AxisMotion& motion, BodyFrame& frame);

/// A body's rotation as snapshots hold it.
struct SampledRotation {
  Eigen::Vector3d axis;
  Eigen::Vector3d omega;  ///< angular velocity across the axis
  Eigen::Vector3d phi_lab;
  Eigen::Vector2d phi_body;
};

/// Returns the rotation that advance() leads to, with the same bits: for bodies without spin in less than half of its
/// time, as no orientation about the axis is carried along.
SampledRotation sampled(const UniaxialInertia& inertia, double t, const AxisMotion& motion, const BodyFrame& frame);

/// Moves a body to time t, exactly, and updates the integrals of omega.
void advance(const UniaxialInertia& inertia, double t, AxisMotion& motion, BodyFrame& frame);

}  // namespace ed::internal
