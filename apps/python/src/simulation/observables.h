#pragma once

#include "simulation/simulation.h"

#include <nanobind/nanobind.h>

#include <memory>

namespace hardbody::python {

/// Observables of a simulation, with that simulation.
struct PythonObservables {
  nb::object simulation;
  std::shared_ptr<Measurement> measurement;
};

/// Returns the options of measuring a state, with defaults for what is None. Throws ValueError.
ed::ObservablesOptions measuring_options(const BodySystem& bodies, nb::handle duration, nb::handle longest_lag,
                                         nb::handle wave_numbers, nb::handle collective, nb::handle order,
                                         nb::handle order_neighbours);

}  // namespace hardbody::python
