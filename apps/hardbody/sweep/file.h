#pragma once

/// A sweep's configuration: that of its runs, and the grid of what changes from one to the next.

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
  std::filesystem::path directory;  ///< of the sweep's file: what names of files in `whole` are relative to
  TomlDocument whole;               ///< the base config with the grids: what the sweep directory keeps
  TomlDocument base;  ///< the config of all points but for what the grids change; names of files are absolute
  std::vector<Grid> grids;
  std::optional<std::string> chain;  ///< the key along which points start from their neighbours
};

/// Reads it, and its base config if it names one. Throws InputError; the names of the config's keys, the grid's too,
/// are checked by read_config.
SweepFile read_sweep(const std::filesystem::path& path);

/// The same from a text; `name` is what messages call it, `directory` where a base is looked for.
SweepFile parse_sweep(std::string_view text, const std::string& name, const std::filesystem::path& directory);

/// The document of a sweep in `from` for a file in `to`: what names files relatively names the same files.
TomlDocument moved(TomlDocument whole, const std::filesystem::path& from, const std::filesystem::path& to);

/// The document of a sweep in that directory with absolute names of files, by which it is compared.
TomlDocument absolute_files(TomlDocument whole, const std::filesystem::path& directory);

/// The config of a point, as far as it is known without running it.
TomlDocument document_of(const SweepFile& sweep, const SweepPoint& point);

/// A key that has not the value it had; "not there" where it is missing.
struct ChangedKey {
  std::string key;
  std::string where;  ///< file:line of the new value, or the file
  std::string before;
  std::string now;
};

/// The first one; nothing if all values are the same.
std::optional<ChangedKey> changed_key(const TomlDocument& before, const TomlDocument& now);

}  // namespace hardbody
