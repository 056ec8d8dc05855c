#include "base/exceptions.h"

#include <base/errors.h>
#include <io/text_file.h>

#include <nanobind/nanobind.h>

#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>

namespace hardbody::python {
namespace {

/// Sets an exception. Bytes of files and their names that are no Unicode are replaced in its message.
void set_error(PyObject* type, const char* message) {
  PyObject* const text = PyUnicode_DecodeUTF8(message, static_cast<Py_ssize_t>(std::strlen(message)), "replace");
  if (text == nullptr) return;
  PyErr_SetObject(type, text);
  Py_DECREF(text);
}

/// Sets an OSError with errno, text and file name; Python chooses its class, such as FileNotFoundError.
void set_os_error(const WriteError& error) {
  PyObject* const reason =
      PyUnicode_DecodeUTF8(error.reason().data(), static_cast<Py_ssize_t>(error.reason().size()), "replace");
  PyObject* const path =
      PyUnicode_DecodeFSDefaultAndSize(error.path().data(), static_cast<Py_ssize_t>(error.path().size()));
  PyObject* const arguments =
      reason == nullptr || path == nullptr ? nullptr : Py_BuildValue("(iOO)", error.number(), reason, path);
  if (arguments != nullptr) PyErr_SetObject(PyExc_OSError, arguments);
  Py_XDECREF(arguments);
  Py_XDECREF(path);
  Py_XDECREF(reason);
}

/// Returns a message of the libraries that begins with "Scene::move" as one that begins with "Scene.move".
std::string with_python_name(std::string message) {
  for (const char* const name : {"Scene::", "GivenMotion::"}) {
    if (message.starts_with(name)) message.replace(std::strlen(name) - 2, 2, ".");
  }
  return message;
}

}  // namespace

void register_exceptions() {
  nanobind::register_exception_translator([](const std::exception_ptr& error, void* /*payload*/) {
    try {
      std::rethrow_exception(error);
    } catch (const InputError& e) {
      set_error(PyExc_ValueError, e.what());
    } catch (const WriteError& e) {
      set_os_error(e);
    } catch (const std::invalid_argument& e) {
      set_error(PyExc_ValueError, with_python_name(e.what()).c_str());
    } catch (const std::bad_alloc&) {
      PyErr_SetString(PyExc_MemoryError, "hardbody: what this call computes does not fit into memory");
    }
  });
}

}  // namespace hardbody::python
