#include "find_kernels.h"

#include <sstream>
#include <stdexcept>

namespace ed::internal {

using geom::InstructionSet;

UniaxialKernels find_uniaxial_kernels(const std::optional<InstructionSet>& batches) {
  if (!batches) return {};
  if (!geom::is_available(*batches)) {
    std::ostringstream message;
    message << "batches: " << geom::to_string(*batches)
            << ", which this processor or this build does not have; accepted: none, best";
    for (const InstructionSet other : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512}) {
      if (geom::is_available(other)) message << ", " << geom::to_string(other);
    }
    throw std::invalid_argument(message.str());
  }
  const InstructionSet set = *batches == InstructionSet::best ? geom::batch_instruction_set() : *batches;
#ifdef HARDBODY_X86_KERNELS
  if (set == InstructionSet::avx2) return uniaxial_kernels_avx2();
  if (set == InstructionSet::avx512) return uniaxial_kernels_avx512();
#endif
  return *batches == InstructionSet::best ? UniaxialKernels{} : uniaxial_kernels_portable();
}

}  // namespace ed::internal
