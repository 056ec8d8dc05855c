#pragma once

#include <string>

namespace hardbody::python {

/// Returns a message of a command with Python's words for options of the command line: "force=True" for "--force".
std::string in_python(std::string message);

}  // namespace hardbody::python
