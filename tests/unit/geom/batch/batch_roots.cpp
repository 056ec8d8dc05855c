/// Compiled with AVX-512 F, VL, DQ and BW; called only where the processor has them.

#include "unit/geom/batch/batch_roots.h"

#include <batch/vectors-inl.h>

HWY_BEFORE_NAMESPACE();
namespace geom_test {

void roots_by_estimate(const double* x, double* root, double* inverse_root, double* near_inverse) {
  using namespace geom::kernel;
  static_assert(kLanes == kRootsAtOnce);
  const Real numbers = hn::LoadU(Tag(), x);
  const Roots found = roots(numbers, numbers);
  hn::StoreU(found.a, Tag(), root);
  hn::StoreU(found.inverse_b, Tag(), inverse_root);
  hn::StoreU(geom::kernel::near_inverse(numbers), Tag(), near_inverse);
}

}  // namespace geom_test
HWY_AFTER_NAMESPACE();
