#pragma once

/// Parts of a run's bodies, as the registry of observables takes them.

#include "registry/observables.h"
#include "run/record.h"

#include <cstddef>

namespace hardbody {

/// Returns all bodies of a run. The results must outlive it.
Part part_of_all(const RunRecord& record);

/// Returns a species of a mixture with its results, which must outlive it.
Part part_of_species(const RunRecord& record, std::size_t species, const ed::GroupResults& results);

}  // namespace hardbody
