#pragma once

#include <string>
#include <vector>

namespace hardbody {

/// Returns the version, "0.1.0".
const char* version();

/// Returns the output of `hardbody --version`: version, licence, compiler, flags, libraries.
std::string version_text();

/// Returns the instruction set that the program was compiled for: "-march=x86-64-v3", or a text that says none.
std::string build_arch();

/// Returns the properties of the program that determine the bits of a run: "-march=x86-64-v3, FMA, arithmetic 3".
std::string arithmetic();

/// Returns the instruction sets of this processor that change the last bits of libm's sin, cos and pow.
std::vector<std::string> cpu_features();
/// Returns cpu_features() in one line, separated by blanks.
std::string cpu_feature_text();

}  // namespace hardbody
