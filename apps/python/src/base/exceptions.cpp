#include "base/exceptions.h"

#include <base/errors.h>
#include <io/text_file.h>

#include <nanobind/nanobind.h>

#include <exception>

namespace hardbody::python {

void register_exceptions() {
  nanobind::register_exception_translator([](const std::exception_ptr& error, void* /*payload*/) {
    try {
      std::rethrow_exception(error);
    } catch (const InputError& e) {
      PyErr_SetString(PyExc_ValueError, e.what());
    } catch (const WriteError& e) {
      PyErr_SetString(PyExc_OSError, e.what());
    }
  });
}

}  // namespace hardbody::python
