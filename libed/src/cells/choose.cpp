#include "cells/choose.h"

#include <sstream>
#include <stdexcept>

namespace ed::internal {

using geom::InstructionSet;

namespace {

/// Returns the instruction set that is usually the fastest of the event loop; KernelTrial tries the others. On one of
/// Intel's processors AVX2 made 6 % more collisions a second than AVX-512 in eight runs, and 3 % fewer in a ninth
/// (`bench_engine --benchmark_filter=vectors/`). On one of AMD's AVX2 makes 3 % fewer.
InstructionSet best_in_the_loop() {
  const InstructionSet set = geom::batch_instruction_set();
#ifdef __x86_64__
  if (set == InstructionSet::avx512 && __builtin_cpu_is("intel")) return InstructionSet::avx2;
#endif
  return set;
}

void check_available(InstructionSet set) {
  if (geom::is_available(set)) return;
  std::ostringstream message;
  message << "batches: " << geom::to_string(set)
          << ", which this processor or this build does not have; accepted: none, best";
  for (const InstructionSet other : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512}) {
    if (geom::is_available(other)) message << ", " << geom::to_string(other);
  }
  throw std::invalid_argument(message.str());
}

}  // namespace

InstructionSet chosen_in_the_loop(InstructionSet set) {
  check_available(set);
  return set == InstructionSet::best ? best_in_the_loop() : set;
}

CellKernel* find_cell_kernel(const std::optional<InstructionSet>& batches) {
#ifdef __x86_64__
  const InstructionSet set = batches ? chosen_in_the_loop(*batches) : InstructionSet::portable;
  if (set == InstructionSet::avx2) return cell_kernel_avx2();
  if (set == InstructionSet::avx512) return cell_kernel_avx512();
#else
  if (batches) check_available(*batches);
#endif
  return cell_kernel_portable();
}

}  // namespace ed::internal
