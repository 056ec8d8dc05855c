#pragma once

/// Checks that the bodies of a config fit into its box. Private to config.cpp.

#include "config/config.h"
#include "io/toml_document.h"

namespace hardbody {

/// Throws InputError if the box is too small for nearest images or the neighbour search, naming what would do.
void check_box(const TomlDocument& document, const Config& config);

/// Makes the start on a lattice, if that is wanted: nothing else tells whether it can be made. Throws InputError.
void check_lattice(const TomlDocument& document, const Config& config);

}  // namespace hardbody
