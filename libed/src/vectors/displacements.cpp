#include "vectors/displacements.h"

#include <geom/batch.h>

namespace ed::internal {

DisplacementKernel* find_displacement_kernel() {
#ifdef __x86_64__
  const geom::InstructionSet set = geom::batch_instruction_set();
  if (set == geom::InstructionSet::avx2) return displacement_kernel_avx2();
  if (set == geom::InstructionSet::avx512) return displacement_kernel_avx512();
#endif
  return displacement_kernel_portable();
}

}  // namespace ed::internal
