/// Included once by each batch_roots_*.cpp, which sets HARDBODY_BATCH_ROOTS, the function's name, and is compiled for
/// its own instruction set; called only where the processor has it.

#include "unit/geom/batch/batch_roots.h"

#include <batch/vectors-inl.h>

HWY_BEFORE_NAMESPACE();
namespace geom_test {

void HARDBODY_BATCH_ROOTS(const double* x, double* root, double* inverse_root, double* near_inverse) {
  using namespace geom::kernel;
  static_assert(kRootsAtOnce % kLanes == 0);
  for (int lane = 0; lane < kRootsAtOnce; lane += kLanes) {
    const Real numbers = hn::LoadU(Tag(), x + lane);
    const Roots found = roots(numbers, numbers);
    hn::StoreU(found.a, Tag(), root + lane);
    hn::StoreU(found.inverse_b, Tag(), inverse_root + lane);
    hn::StoreU(geom::kernel::near_inverse(numbers), Tag(), near_inverse + lane);
  }
}

}  // namespace geom_test
HWY_AFTER_NAMESPACE();
