#pragma once

/// Files that Python names.

#include <ed/sink.h>

#include <nanobind/nanobind.h>

#include <functional>
#include <string>

namespace hardbody::python {

namespace nb = nanobind;

/// Returns the absolute name of a file that exists; `name`: that of the argument. Throws TypeError or
/// FileNotFoundError.
std::string existing_path(nb::handle path, const char* name = "path");

/// Returns the content of a file. Throws FileNotFoundError or InputError.
std::string read_state(nb::handle path, const char* name);

/// Writes a file, whole or not at all. Throws WriteError.
void write_state(nb::handle path, const std::function<void(const ed::archive::Sink&)>& make);

}  // namespace hardbody::python
