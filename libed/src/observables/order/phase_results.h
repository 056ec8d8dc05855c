#pragma once

/// Values of order from the sums that blocks hold.

#include "observables/block_averages.h"

#include <ed/observables.h>

#include <cstddef>

namespace ed::internal {

/// Adds Bragg peaks, orders of layers and columns, q_4, q_6 and psi_6, of all bodies.
void add_phase(const BlockAverages& averages, Results& results);

/// Adds the cubatic order of a part of the structure: 0 for all bodies, then groups.
void add_cubatic(const BlockAverages& averages, std::size_t part, bool three_axes, GroupResults& results);

}  // namespace ed::internal
