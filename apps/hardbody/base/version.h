#pragma once

#include <string>
#include <vector>

namespace hardbody {

/// "0.1.0"
const char* version();

/// What `hardbody --version` prints: version, licence, compiler, flags, libraries.
std::string version_text();

/// The instruction set that the program was compiled for: "-march=x86-64-v3", or that there is none.
std::string build_arch();

/// That, and all else of the program that decides the bits of a run: "-march=x86-64-v3, FMA, arithmetic 3".
std::string arithmetic();

/// The instruction sets of this processor that change the last bits of libm's sin, cos and pow.
std::vector<std::string> cpu_features();
/// The same in one line, separated by blanks.
std::string cpu_feature_text();

}  // namespace hardbody
