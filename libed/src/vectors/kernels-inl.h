/// The kernels of bodies of revolution.
///
/// Included once by each vectors/kernels_*.cpp, which sets HARDBODY_UNIAXIAL_KERNELS, the function's name, and is
/// compiled for its own instruction set. All else here has internal linkage (vectors/kernels.h says why).
///
/// A lane gives the bits that the code for one pair gives: the same formulas in the same order, without fused
/// multiply-add. What a lane computes does not depend on its neighbours.

#include "base/highway-inl.h"
#include "vectors/kernels.h"

#include "vectors/look_kernel-inl.h"
#include "vectors/overlap_kernel-inl.h"
#include "vectors/rod_looks-inl.h"

namespace ed::internal {

UniaxialKernels HARDBODY_UNIAXIAL_KERNELS() {
  return {.spheroids = {look<Pairs<false>>, look<Pairs<true>>, overlap<Family::spheroids>},
          .rods = {look<RodPairs<false>>, look<RodPairs<true>>, overlap<Family::rods>},
          .spheres = {look_spheres, look_spheres, overlap<Family::spheres>}};
}

}  // namespace ed::internal
