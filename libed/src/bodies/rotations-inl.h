/// The kernel of rotations. Included by bodies/rotations_portable.cpp, rotations_avx2.cpp and rotations_avx512.cpp,
/// which set HARDBODY_ROTATION_KERNEL, the function's name (vectors/kernels-inl.h says why).

#include "base/highway-inl.h"
#include "bodies/rotations.h"

#include "vectors/sincos-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ed::internal {
namespace {

static_assert(kRotationsAtATime % kLanes == 0);

HWY_INLINE Real3 load3(const RotationRows::Row* rows, int lane) {
  return {load(rows[0], lane), load(rows[1], lane), load(rows[2], lane)};
}

HWY_INLINE Real3 cross(const Real3& a, const Real3& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

HWY_INLINE Real3 renormalized(const Real3& v) {
  return v + (0.5 * (1 - v.squaredNorm())) * v;
}

// The operations of sampled() and advance(), in the same order.

/// Sets axis and omega of bodies that spin, as set_rotation() does.
HWY_INLINE void set_with_spin(RotationRows& bodies, int i, const Real3& u, const Real3& omega) {
  const Real perpendicular = load(bodies.perpendicular, i), spin = load(bodies.spin, i);
  const Real3 L = perpendicular * omega + (load(bodies.axial, i) * spin) * u;
  const Real length = sqrt(L.squaredNorm());
  const Real3 l = select(length > 0, Real3(L.x() / length, L.y() / length, L.z() / length), u);
  const Real3 e0 = l.dot(u) * l;
  const Real3 axis = e0 + (u - e0);
  store3(axis, bodies.axis, i);
  store3((length / perpendicular) * cross(axis, cross(l, u)), bodies.omega, i);
}

/// Returns what integrate_across() does.
HWY_INLINE void integrate_across(Real w1, Real w2, Real k, Real t, Real& first, Real& second) {
  const Real x = k * t;
  Real sin, cos;
  sincos(0.5 * x, sin, cos);
  const Lanes large = abs(x) > 1e-3;
  const Real sinc = select(large, 2 * sin * cos / x, 1 - x * x / 6);
  const Real cosc = select(large, 2 * sin * sin / x, x * (0.5 - x * x / 24));
  first = t * (sinc * w1 + cosc * w2);
  second = t * (sinc * w2 - cosc * w1);
}

template <bool kSpins>
HWY_INLINE void set_rotations(RotationRows& bodies, int i) {
  const Real dt = load(bodies.dt, i), rate = load(bodies.rate, i);
  const Real3 e0 = load3(bodies.e0, i), e1 = load3(bodies.e1, i), e2 = load3(bodies.e2, i);
  const Real3 axis = e0 + e1, x_axis = load3(bodies.x_axis, i), l = load3(bodies.momentum_dir, i);
  const Real3 omega = rate * cross(axis, e2);
  const Real3 y_axis = cross(axis, x_axis);
  const Real angle = rate * dt;
  Real sin, cos;
  sincos(angle, sin, cos);
  const Real3 u = renormalized(e0 + cos * e1 + sin * e2);
  const Real3 turned = cos * e2 - sin * e1;
  Real3 phi_lab = load3(bodies.phi_lab, i) + angle * l;
  Real phi_x = dt * omega.dot(x_axis), phi_y = dt * omega.dot(y_axis);
  if (kSpins) {
    const Real along = l.dot(axis);
    phi_lab = phi_lab - along * (angle * e0 + sin * e1 + (1 - cos) * e2);
    integrate_across(omega.dot(x_axis), omega.dot(y_axis), load(bodies.spin, i) - rate * along, dt, phi_x, phi_y);
    set_with_spin(bodies, i, u, rate * cross(u, turned));
  } else {
    store3(u, bodies.axis, i);
    store3(rate * cross(u, renormalized(turned - u.dot(turned) * u)), bodies.omega, i);
  }
  store3(phi_lab, bodies.phi_lab, i);
  store(load(bodies.phi_body[0], i) + phi_x, bodies.phi_body[0], i);
  store(load(bodies.phi_body[1], i) + phi_y, bodies.phi_body[1], i);
}

void set_rotations(RotationRows& bodies, bool spins) {
  for (int i = 0; i < kRotationsAtATime; i += kLanes) {
    spins ? set_rotations<true>(bodies, i) : set_rotations<false>(bodies, i);
  }
}

}  // namespace

RotationKernel* HARDBODY_ROTATION_KERNEL() {
  return set_rotations;
}

}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
