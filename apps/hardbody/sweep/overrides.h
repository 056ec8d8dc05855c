#pragma once

/// Values from the command line that replace those of a sweep's file.

#include "io/toml_document.h"
#include "sweep/grid.h"

#include <string>
#include <vector>

namespace hardbody {

struct SweepOverrides {
  std::vector<Entry> own;     ///< values of grids and of the sweep's own keys
  std::vector<Entry> config;  ///< values of the config of all points
};

/// Reads overrides of the form key=value; names of files are relative to the working directory and become absolute.
/// Throws InputError for a text of another form and for unknown keys at the top.
SweepOverrides read_overrides(const std::vector<std::string>& texts, const std::string& name);

/// Lays values over the grids and own keys of a sweep's file; a new key of a grid becomes its last, and the first key
/// of a file without grids makes one. Throws InputError if there is no such grid.
void lay_over_own(TomlDocument& document, std::vector<Entry> own);

/// Lays values over the config of all points. Throws InputError for a key that is in a grid.
void lay_over_config(TomlDocument& base, std::vector<Entry> config, const std::vector<Grid>& grids);

}  // namespace hardbody
