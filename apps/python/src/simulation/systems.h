#pragma once

/// States of bodies in a periodic box, as Python sees them.

#include "base/arguments.h"

#include <ed/observables.h>
#include <ed/system.h>

#include <nanobind/nanobind.h>

#include <functional>
#include <vector>

namespace hardbody::python {

namespace nb = nanobind;

/// State with the groups that its bodies form.
struct BodySystem {
  ed::System system;
  std::vector<int> groups;  ///< numbers of bodies of consecutive groups: species, or sizes of one
};

/// Returns the groups that the bodies' species make: those of ed::rescale_velocities.
std::vector<int> groups_of(const ed::System& system);

/// Returns groups as observables take them. Throws ValueError if bodies of one group rotate about different numbers of
/// axes.
std::vector<ed::BodyGroup> body_groups(const BodySystem& bodies);

/// Arrays of a state, one row a body.
/// @{
nb::object positions_of(const ed::System& system);
nb::object orientations_of(const ed::System& system);
nb::object rotations_of(const ed::System& system);
nb::object velocities_of(const ed::System& system);
nb::object angular_velocities_of(const ed::System& system);
/// @}

/// Returns <u u> order of the bodies' axes: the largest eigenvalue of Q.
double nematic_order_of(const ed::System& system);

}  // namespace hardbody::python
