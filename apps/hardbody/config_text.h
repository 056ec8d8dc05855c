#pragma once

#include "config.h"

#include <string>

namespace hardbody {

/// A config as TOML with every key and a comment that says what it is, in what unit. Reading it gives the
/// same Config, to the bit.
std::string config_text(const Config& config, const std::string& header);

/// What `hardbody init` writes.
std::string template_text();

/// What a run directory holds: the defaults filled in.
std::string resolved_text(const Config& config);

}  // namespace hardbody
