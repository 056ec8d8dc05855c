#include "vectors/products.h"

#include <geom/batch.h>

namespace ed::internal {

ProductKernel* find_product_kernel() {
#ifdef __x86_64__
  const geom::InstructionSet set = geom::batch_instruction_set();
  if (set == geom::InstructionSet::avx2) return product_kernel_avx2();
  if (set == geom::InstructionSet::avx512) return product_kernel_avx512();
#endif
  return product_kernel_portable();
}

}  // namespace ed::internal
