#pragma once

/// Bodies of a config: [shape] or [[species]].

#include "config/config.h"
#include "io/toml_document.h"

#include <ed/shape.h>

namespace hardbody {

/// Returns the body of a shape that has been read. `literal`: lengths are taken as they are given.
ed::BodyShape body_shape(const ShapeConfig& shape, bool literal);

/// Reads [shape] with [dynamics] inertia, or all [[species]], with the number of bodies of each and their sizes. Throws
/// InputError.
void read_species(const TomlDocument& document, Config& config);

/// Returns a config of the same bodies in the same proportions, `number` of them or as few more as that takes: sizes
/// are drawn anew.
Config with_number(Config config, int number);

}  // namespace hardbody
