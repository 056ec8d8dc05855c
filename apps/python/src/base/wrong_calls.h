#pragma once

#include <string>
#include <string_view>

namespace hardbody::python {

/// Returns nanobind's message about a call whose arguments fit no signature (too many, too few, of an unknown name) as
/// one line of the package's form: what the call is given, and what is accepted. Returns other messages as they are.
///
/// The linker hands every message of a TypeError to it (wrong_calls.cpp).
std::string in_one_line(std::string_view message);

}  // namespace hardbody::python
