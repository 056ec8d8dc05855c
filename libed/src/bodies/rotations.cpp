#include "bodies/rotations.h"

#include <geom/batch.h>

namespace ed::internal {

RotationKernel* find_rotation_kernel() {
#ifdef __x86_64__
  const geom::InstructionSet set = geom::batch_instruction_set();
  if (set == geom::InstructionSet::avx2) return rotation_kernel_avx2();
  if (set == geom::InstructionSet::avx512) return rotation_kernel_avx512();
#endif
  return rotation_kernel_portable();
}

}  // namespace ed::internal
