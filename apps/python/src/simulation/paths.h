#pragma once

/// Files that Python names.

#include <ed/sink.h>

#include <nanobind/nanobind.h>

#include <functional>
#include <string>

namespace hardbody::python {

namespace nb = nanobind;

/// Returns the absolute name of a file that exists. Throws TypeError or FileNotFoundError.
std::string existing_path(nb::handle path);

/// Returns the content of a file. Throws FileNotFoundError or InputError.
std::string read_state(nb::handle path);

/// Writes a file, whole or not at all. Throws WriteError.
void write_state(nb::handle path, const std::function<void(const ed::archive::Sink&)>& make);

}  // namespace hardbody::python
