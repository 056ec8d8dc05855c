#pragma once

/// Motions given as functions of time.

#include "base/arguments.h"

#include <ed/given/contact.h>
#include <ed/given/motion.h>

#include <nanobind/nanobind.h>

#include <string>

namespace hardbody::python {

/// Defines the class GivenMotion.
void bind_given_motion(nb::module_& module);

/// Returns whether an object is a GivenMotion.
bool is_given_motion(nb::handle value);

/// Returns the motion of a GivenMotion or of a Motion, a free flight. Throws TypeError if the object is neither.
ed::GivenMotion given_motion(nb::handle value, const std::string& name);

/// Reads the options of a search; None: their defaults.
ed::GivenContactOptions given_options(nb::handle max_evaluations, nb::handle tolerance);

}  // namespace hardbody::python
