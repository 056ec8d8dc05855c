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

// The operations of sampled(), in the same order.
void set_rotations(RotationRows& bodies) {
  for (int i = 0; i < kRotationsAtATime; i += kLanes) {
    const Real dt = load(bodies.dt, i), rate = load(bodies.rate, i);
    const Real3 e0 = load3(bodies.e0, i), e1 = load3(bodies.e1, i), e2 = load3(bodies.e2, i);
    const Real3 axis = e0 + e1, x_axis = load3(bodies.x_axis, i);
    const Real3 omega = rate * cross(axis, e2);
    const Real3 y_axis = cross(axis, x_axis);
    const Real angle = rate * dt;
    Real sin, cos;
    sincos(angle, sin, cos);
    const Real3 u = renormalized(e0 + cos * e1 + sin * e2);
    const Real3 turned = cos * e2 - sin * e1;
    const Real3 across = renormalized(turned - u.dot(turned) * u);
    store3(u, bodies.axis, i);
    store3(rate * cross(u, across), bodies.omega, i);
    store3(load3(bodies.phi_lab, i) + angle * load3(bodies.momentum_dir, i), bodies.phi_lab, i);
    store(load(bodies.phi_body[0], i) + dt * omega.dot(x_axis), bodies.phi_body[0], i);
    store(load(bodies.phi_body[1], i) + dt * omega.dot(y_axis), bodies.phi_body[1], i);
  }
}

}  // namespace

RotationKernel* HARDBODY_ROTATION_KERNEL() {
  return set_rotations;
}

}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
