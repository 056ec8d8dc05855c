#pragma once

/// Functions that define this room's part of the extension.

#include <nanobind/nanobind.h>

namespace hardbody::python {

void bind_commands(nanobind::module_& module);
void bind_program(nanobind::module_& module);
void bind_plots(nanobind::module_& module);

}  // namespace hardbody::python
