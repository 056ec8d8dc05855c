#include "motion/axis_motion.h"

#include <cmath>

namespace ed::internal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Returns the integral over [0, t] of (w1 + i w2) exp(-i k s): the angular velocity across the axis in the body's
/// frame.
Vector2d integrate_across(const Vector2d& w, double k, double t) {
  const double x = k * t;
  double sinc = 1 - x * x / 6;
  double cosc = x * (0.5 - x * x / 24);  // (1 - cos x) / x
  if (std::abs(x) > 1e-3) {
    const SinCos a = sincos(0.5 * x);
    sinc = 2 * a.sin * a.cos / x;
    cosc = 2 * a.sin * a.sin / x;
  }
  return t * Vector2d(sinc * w.x() + cosc * w.y(), sinc * w.y() - cosc * w.x());
}

}  // namespace

void set_rotation(const UniaxialInertia& inertia, const Vector3d& u, const Vector3d& omega, AxisMotion& motion,
                  BodyFrame& frame) {
  if (!inertia.spins) {
    const double rate = omega.norm();
    // The axis of a body that does not rotate may have any relation to L: any direction across u serves as that of L.
    const Vector3d l = rate > 0 ? Vector3d(omega / rate) : u.unitOrthogonal();
    motion.e0.setZero();
    motion.e1 = u;
    motion.e2 = l.cross(u);
    motion.rate = rate;
    frame.momentum_dir = l;
    return;
  }
  const Vector3d L = inertia.perpendicular * omega + (inertia.axial * frame.spin) * u;
  const double length = L.norm();
  const Vector3d l = length > 0 ? Vector3d(L / length) : u;
  motion.e0 = l.dot(u) * l;
  motion.e1 = u - motion.e0;
  motion.e2 = l.cross(u);
  motion.rate = length / inertia.perpendicular;
  frame.momentum_dir = l;
}

void advance(const UniaxialInertia& inertia, double t, AxisMotion& motion, BodyFrame& frame) {
  const double dt = t - motion.time;
  if (dt == 0) return;
  const Vector3d u = motion.axis();
  const Vector3d omega = omega_across(motion);
  const Vector3d l = frame.momentum_dir;
  const double angle = motion.rate * dt;
  const SinCos sc = sincos(angle);

  // Integrals of omega. Across the axis omega(t) = Omega l - Omega (u.l) u(t), which integrates term by term.
  const Vector2d omega_body(omega.dot(frame.x_axis), omega.dot(u.cross(frame.x_axis)));
  double own_rate = 0;  // rate about the body's own axis, in addition to that about l
  frame.phi_lab += angle * l;
  if (inertia.spins) {
    const double cos_alpha = l.dot(u);
    frame.phi_lab -= cos_alpha * (angle * motion.e0 + sc.sin * motion.e1 + (1 - sc.cos) * motion.e2);
    own_rate = frame.spin - motion.rate * cos_alpha;
  }
  frame.phi_body += integrate_across(omega_body, own_rate, dt);

  // Body x: first about u, then about l.
  Vector3d x = frame.x_axis;
  if (own_rate != 0) {
    const SinCos own = sincos(own_rate * dt);
    x = own.cos * x + own.sin * u.cross(x);
  }
  x = sc.cos * x + sc.sin * l.cross(x) + ((1 - sc.cos) * l.dot(x)) * l;

  const Vector3d u_new = renormalized(motion.e0 + sc.cos * motion.e1 + sc.sin * motion.e2);
  const Vector3d e2_new = sc.cos * motion.e2 - sc.sin * motion.e1;
  if (inertia.spins) {
    // omega = u x du/dt; made orthogonal to u again so that rounding does not feed the spin.
    set_rotation(inertia, u_new, motion.rate * u_new.cross(e2_new), motion, frame);
  } else {
    motion.e1 = u_new;
    motion.e2 = renormalized(e2_new - u_new.dot(e2_new) * u_new);
    frame.momentum_dir = u_new.cross(motion.e2);
  }
  frame.x_axis = renormalized(x - u_new.dot(x) * u_new);
  motion.position += dt * motion.velocity;
  motion.time = t;
}

SampledRotation sampled(const UniaxialInertia& inertia, double t, const AxisMotion& motion, const BodyFrame& frame) {
  if (inertia.spins || t == motion.time) {
    AxisMotion m = motion;
    BodyFrame f = frame;
    advance(inertia, t, m, f);
    return {m.axis(), omega_across(m), f.phi_lab, f.phi_body};
  }
  const double dt = t - motion.time;
  const Vector3d omega = omega_across(motion);
  const Vector3d y_axis = motion.axis().cross(frame.x_axis);
  const double angle = motion.rate * dt;
  const SinCos sc = sincos(angle);
  const Vector3d u = renormalized(motion.e0 + sc.cos * motion.e1 + sc.sin * motion.e2);
  const Vector3d e2 = sc.cos * motion.e2 - sc.sin * motion.e1;
  const Vector3d across = renormalized(e2 - u.dot(e2) * u);
  return {u, motion.rate * u.cross(across), frame.phi_lab + angle * frame.momentum_dir,
          frame.phi_body + dt * Vector2d(omega.dot(frame.x_axis), omega.dot(y_axis))};
}

}  // namespace ed::internal
