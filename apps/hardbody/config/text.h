#pragma once

#include "config/config.h"

#include <optional>
#include <string>
#include <string_view>

namespace hardbody {

/// Returns a config as TOML with every key and a comment that says what it is, in what unit. Reading it gives the same
/// Config, to the bit.
std::string config_text(const Config& config, const std::string& header);

/// Returns what `hardbody init --template NAME` writes; nullopt if there is no such template.
std::optional<std::string> template_text(std::string_view name);
/// Returns "ellipsoid, superball, capsule, polyhedron, mixture, sweep"; the first is the default.
std::string template_names();

/// Returns the config.toml of a run directory: the defaults filled in.
std::string resolved_text(const Config& config);

}  // namespace hardbody
