#pragma once

#include "simulation/systems.h"

#include <nanobind/nanobind.h>

namespace hardbody::python {

/// Arguments of System.
struct SystemArguments {
  nb::handle box, species, positions, orientations, velocities, angular_velocities, species_of, groups;
};

/// Returns the state that arrays describe. Throws TypeError or ValueError, naming the argument.
BodySystem make_system(const SystemArguments& given);

}  // namespace hardbody::python
