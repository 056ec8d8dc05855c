#include "vectors/choose.h"

#include "cells/choose.h"

namespace ed::internal {

using geom::InstructionSet;

UniaxialKernels find_uniaxial_kernels(const std::optional<InstructionSet>& batches) {
  if (!batches) return {};
#ifdef __x86_64__
  const InstructionSet set = chosen_in_the_loop(*batches);
  if (set == InstructionSet::avx2) return uniaxial_kernels_avx2();
  if (set == InstructionSet::avx512) return uniaxial_kernels_avx512();
#else
  (void)chosen_in_the_loop(*batches);
#endif
  return *batches == InstructionSet::best ? UniaxialKernels{} : uniaxial_kernels_portable();
}

}  // namespace ed::internal
