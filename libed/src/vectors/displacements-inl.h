/// The kernel of displacements. Included by vectors/displacements_portable.cpp, displacements_avx2.cpp and
/// displacements_avx512.cpp, which set
/// HARDBODY_DISPLACEMENT_KERNEL, the function's name (vectors/kernels-inl.h says why).

#include "base/highway-inl.h"
#include "vectors/displacements.h"

#include "vectors/sincos-inl.h"

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ed::internal {
namespace {

static_assert(kDisplacementsAtATime % kLanes == 0);

/// Returns the positions of successive bodies.
HWY_INLINE Real3 load_positions(const double* at) {
  Real x, y, z;
  hn::LoadInterleaved3(Tag(), at, x.v, y.v, z.v);
  return {x, y, z};
}

void set_displacements(const double* from, const double* to, const double* wave_numbers, int number, double* squares,
                       double* scattering) {
  for (std::ptrdiff_t i = 0; i < kDisplacementsAtATime; i += kLanes) {
    const Real3 moved = load_positions(to + 3 * i) - load_positions(from + 3 * i);
    const Real square = moved.squaredNorm();
    hn::StoreU(square.v, Tag(), squares + i);
    const Real r = sqrt(square);
    for (std::ptrdiff_t k = 0; k < number; ++k) {
      const Real angle = wave_numbers[k] * r;
      Real sin, cos;
      sincos(angle, sin, cos);
      hn::StoreU((sin / angle).v, Tag(), scattering + k * kDisplacementsAtATime + i);
    }
  }
}

}  // namespace

DisplacementKernel* HARDBODY_DISPLACEMENT_KERNEL() {
  return set_displacements;
}

}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
