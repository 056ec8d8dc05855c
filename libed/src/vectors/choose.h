#pragma once

/// Which kernels to use.

#include "cells/kernels.h"
#include "vectors/kernels.h"

#include <geom/batch.h>

#include <optional>

namespace ed::internal {

/// `batches`: as SimulationOptions has it. None for `best` where that would be vectors of one lane: they are slower
/// than one pair at a time. Throws std::invalid_argument if the processor or the build does not have the instruction
/// set.
UniaxialKernels find_uniaxial_kernels(const std::optional<geom::InstructionSet>& batches);

/// Of the same instruction set; that of the whole library for none. Throws as find_uniaxial_kernels.
CellKernel* find_cell_kernel(const std::optional<geom::InstructionSet>& batches);

}  // namespace ed::internal
