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

class PythonSimulation;
/// Defines run and what else changes a simulation.
void bind_simulation_runs(nanobind::class_<PythonSimulation>& type);
/// Defines arrays and numbers of a simulation's state.
void bind_simulation_numbers(nanobind::class_<PythonSimulation>& type);

}  // namespace hardbody::python
