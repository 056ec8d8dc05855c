#pragma once

#include <string>
#include <vector>

namespace hardbody {

/// "0.1.0"
const char* version();

/// What `hardbody --version` prints: version, licence, compiler, flags, libraries.
std::string version_text();

/// The instruction sets of this processor that change the last bits of libm's sin, cos and pow.
std::vector<std::string> cpu_features();

}  // namespace hardbody
