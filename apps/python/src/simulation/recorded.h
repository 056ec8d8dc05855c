#pragma once

#include "simulation/simulation.h"

#include <nanobind/nanobind.h>

namespace hardbody::python {

/// Returns the recorded collisions as a structured array: time, i, j.
nb::object recorded(const PythonSimulation& simulation);

}  // namespace hardbody::python
