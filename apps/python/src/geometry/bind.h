#pragma once

/// Functions that define this room's part of the extension.

#include <nanobind/nanobind.h>

namespace hardbody::python {

void bind_shapes(nanobind::module_& module);
void bind_core_shapes(nanobind::module_& module);
void bind_poses(nanobind::module_& module);
void bind_motions(nanobind::module_& module);
void bind_queries(nanobind::module_& module);
void bind_masses(nanobind::module_& module);
void bind_contacts(nanobind::module_& module);
void bind_distances(nanobind::module_& module);
void bind_derivatives(nanobind::module_& module);
void bind_patches(nanobind::module_& module);
void bind_body_queries(nanobind::module_& module);
void bind_custom_shapes(nanobind::module_& module);

}  // namespace hardbody::python
