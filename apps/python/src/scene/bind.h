#pragma once

/// Functions that define this room's part of the extension.

#include <nanobind/nanobind.h>

namespace hardbody::python {

void bind_scenes(nanobind::module_& module);

}  // namespace hardbody::python
