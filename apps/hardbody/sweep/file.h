#pragma once

/// Configuration of a sweep: the config of its runs, and the grid of what changes from one run to the next.

#include "config/config.h"
#include "io/toml_document.h"
#include "sweep/grid.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

struct SweepFile {
  std::filesystem::path directory;  ///< directory of the sweep's file, to which names of files in `whole` are relative
  TomlDocument whole;               ///< base config with the grids, as stored in the sweep directory
  TomlDocument base;                ///< config of all points except what the grids change; names of files are absolute
  std::vector<Grid> grids;
  std::optional<std::string> chain;  ///< key along which points start from their neighbours
  int replicas = 1;                  ///< runs of each point, with different seeds
};

/// Reads a sweep's file, and its base config if it names one, with `overrides` (section.key=value,
/// grid.section.key=list) laid over it. Throws InputError; the names of the config's keys, also those in the grid, are
/// checked by read_config.
SweepFile read_sweep(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

/// Parses a sweep's text; `name` is used in messages, `directory` is where a base is searched for.
SweepFile parse_sweep(std::string_view text, const std::string& name, const std::filesystem::path& directory,
                      const std::vector<std::string>& overrides = {}, Lines lines = Lines::named);

/// Returns the document of a sweep in `from` for a file in `to`: relative names of files are changed so that they name
/// the same files.
TomlDocument moved(TomlDocument whole, const std::filesystem::path& from, const std::filesystem::path& to);

/// Returns the document of a sweep in this directory with absolute names of files, for comparisons.
TomlDocument absolute_files(TomlDocument whole, const std::filesystem::path& directory);

/// Returns the config of a point, as far as it is known without running it.
TomlDocument document_of(const SweepFile& sweep, const SweepPoint& point);

}  // namespace hardbody
