#pragma once

/// Reading [shape] and [[species]]. Private to config.cpp.

#include "config/config.h"
#include "io/toml_document.h"

#include <string>

namespace hardbody {

inline constexpr std::int64_t kMostBodies = 1'000'000;

/// What a config calls the bodies of a species: "species[2]".
std::string species_name(std::size_t index);

/// Reads [shape] with [dynamics] inertia, or all [[species]], with the number of bodies of each and their sizes. Throws
/// InputError.
void read_species(const TomlDocument& document, Config& config);

/// The same bodies in the same proportions, `number` of them or as few more as that takes: sizes are drawn anew.
Config with_number(Config config, int number);

}  // namespace hardbody
