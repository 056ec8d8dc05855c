#pragma once

/// Names of keys in the file of a sweep: its own keys, those of the config, those of grids.

#include "io/toml_document.h"

#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

namespace hardbody {

inline constexpr const char* kReplicasKey = "replicas";

/// Returns whether a section is a grid: grid, or grid[2] of several.
bool is_grid(std::string_view section);
/// Returns whether a key is one of a grid.
bool in_grid(const Entry& entry);
/// Returns whether a key at the top is one that configs do not have.
bool is_own_key(const Entry& entry);

/// Checks keys at the top and sections that only a sweep has; all others are checked by the config. Throws InputError.
void check_own_names(const TomlDocument& document);

/// Returns whether a value is a range of numbers, {from, to, ..}.
bool is_range(const Value& value);

/// Returns the entries with full names: shape.aspect_ratio = .. and [grid.shape] with aspect_ratio = .. are the same.
std::vector<Entry> flattened(const TomlDocument& document, const Entry& entry);
/// Overload for all entries.
std::vector<Entry> flattened(const TomlDocument& document);

using Renaming = std::function<std::filesystem::path(const std::filesystem::path&)>;

/// Renames the files of all keys that name files, those of [grid.start] too.
TomlDocument with_files(TomlDocument document, const Renaming& renamed);

}  // namespace hardbody
