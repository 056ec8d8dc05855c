#include "simulation/paths.h"

#include <io/text_file.h>

#include <nanobind/stl/string.h>

#include <cerrno>
#include <filesystem>

#include <unistd.h>

namespace hardbody::python {
namespace {

constexpr std::size_t kLongestState = std::size_t{1} << 35;

std::string path_text(nb::handle path, const char* name) {
  const nb::object text =
      nb::module_::import_("hardbody._calls").attr("path_text")(path, name, nb::arg("only_unicode") = false);
  // Names that are no Unicode have the bytes of the file system.
  const auto encoded = nb::cast<nb::bytes>(nb::module_::import_("os").attr("fsencode")(text));
  return {encoded.c_str(), encoded.size()};
}

/// Throws OSError, or the class of it that errno has in Python, with the file's name.
[[noreturn]] void raise_errno(const std::string& file) {
  PyErr_SetFromErrnoWithFilename(PyExc_OSError, file.c_str());
  throw nb::python_error();
}

}  // namespace

std::string existing_path(nb::handle path, const char* name) {
  const std::string file = path_text(path, name);
  if (::access(file.c_str(), R_OK) != 0) raise_errno(file);
  return absolute_path(file).string();
}

std::string read_state(nb::handle path, const char* name) {
  const std::string file = existing_path(path, name);
  if (std::filesystem::is_directory(file)) {
    errno = EISDIR;
    raise_errno(file);
  }
  return read_file(file, kLongestState);
}

void write_state(nb::handle path, const std::function<void(const ed::archive::Sink&)>& make) {
  write_file(path_text(path, "path"), make);
}

}  // namespace hardbody::python
