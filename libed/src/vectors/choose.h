#pragma once

/// Choice of the kernels for pairs of ellipsoids of revolution.

#include "vectors/kernels.h"

#include <geom/batch.h>

#include <optional>

namespace ed::internal {

/// Returns the kernels for this instruction set (see SimulationOptions::batches). Returns none for `best` where that
/// would be vectors of one lane, which are slower than one pair at a time. Throws std::invalid_argument if the
/// processor or the build does not have the instruction set.
UniaxialKernels find_uniaxial_kernels(const std::optional<geom::InstructionSet>& batches);

}  // namespace ed::internal
