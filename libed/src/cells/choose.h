#pragma once

/// Choice of the instruction set and of the kernel of cells.

#include "cells/kernels.h"

#include <geom/batch.h>

#include <optional>

namespace ed::internal {

/// Returns the instruction set that `set` stands for in the event loop. Throws std::invalid_argument if the processor
/// or the build does not have it.
geom::InstructionSet chosen_in_the_loop(geom::InstructionSet set);

/// Returns the kernel for this instruction set (see SimulationOptions::batches), the portable one for none. Throws
/// std::invalid_argument if the processor or the build does not have the instruction set.
CellKernel* find_cell_kernel(const std::optional<geom::InstructionSet>& batches);

}  // namespace ed::internal
