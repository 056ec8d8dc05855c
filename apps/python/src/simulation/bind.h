#pragma once

/// Functions that define this room's part of the extension.

#include <nanobind/nanobind.h>

namespace hardbody::python {

void bind_species(nanobind::module_& module);
void bind_systems(nanobind::module_& module);
void bind_starts(nanobind::module_& module);
void bind_files(nanobind::module_& module);
void bind_outcomes(nanobind::module_& module);
void bind_observables(nanobind::module_& module);
void bind_simulations(nanobind::module_& module);

}  // namespace hardbody::python
