#pragma once

#include "simulation/systems.h"

#include <ed/simulation.h>

#include <nanobind/nanobind.h>

namespace hardbody::python {

/// Arguments of Simulation that choose its methods.
struct OptionArguments {
  nb::handle envelope, neighbours, finder, distance, root, eps_d, instruction_set, prepare_from, least_progress;
};

/// Returns the options of a simulation of these bodies, with the program's defaults for what is None. Throws TypeError
/// or ValueError, naming the argument.
ed::SimulationOptions simulation_options(const OptionArguments& given, const ed::System& system);

}  // namespace hardbody::python
