#include "base/arguments.h"

#include "base/arrays.h"

#include <nanobind/stl/string_view.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace hardbody::python {
namespace {

constexpr std::size_t kLongestText = 60;

/// Returns a value as messages show it: its repr if that is short, else its type.
std::string value_text(nb::handle value) {
  if (PyLong_Check(value.ptr())) {
    int overflow = 0;  // Python refuses to print very long integers
    PyLong_AsLongLongAndOverflow(value.ptr(), &overflow);
    if (overflow != 0) return "an integer outside -2^63 to 2^63 - 1";
  }
  const auto type = nb::cast<std::string>(value.type().attr("__name__"));
  if (nb::inst_check(value) && !nb::inst_ready(value)) return "an uninitialised " + type;
  if (PyUnicode_Check(value.ptr()) || PyLong_Check(value.ptr()) || PyFloat_Check(value.ptr()) || value.is_none()) {
    const auto text = nb::cast<std::string>(nb::repr(value));
    if (text.size() <= kLongestText) return text;
  }
  return "of type " + type;
}

/// Reads a Python float or int; false for anything else.
bool read_plain(nb::handle value, double& out) {
  if (PyFloat_Check(value.ptr())) {
    out = PyFloat_AsDouble(value.ptr());
    return true;
  }
  if (!PyLong_Check(value.ptr()) || PyBool_Check(value.ptr())) return false;
  out = PyLong_AsDouble(value.ptr());
  if (out == -1 && PyErr_Occurred() != nullptr) {
    PyErr_Clear();  // beyond the range of double
    return false;
  }
  return true;
}

/// Returns an attribute; null if there is none.
nb::object find_attribute(nb::handle object, const char* name) {
  nb::object value = nb::steal(PyObject_GetAttrString(object.ptr(), name));
  if (value.is_valid()) return value;
  nb::python_error error;
  if (!error.matches(PyExc_AttributeError)) throw error;
  return value;
}

/// Returns whether a value is a number of another class, a Fraction or a Decimal, or an integer beyond double.
bool is_number_object(nb::handle value) {
  if (PyBool_Check(value.ptr()) || PyUnicode_Check(value.ptr()) || PyType_Check(value.ptr()) ||
      !has_attribute(value, "__float__"))
    return false;
  return !has_attribute(value, "dtype") && !has_attribute(value, "__array__");
}

double read_object(nb::handle value, const char* name) {
  const nb::object read = nb::steal(PyNumber_Float(value.ptr()));
  if (read.is_valid()) return PyFloat_AsDouble(read.ptr());
  nb::python_error error;
  if (error.matches(PyExc_TypeError)) refuse_type(name, value, "a real number");
  if (error.matches(PyExc_ValueError)) refuse_value(name, value_text(value), "a real number");
  if (!error.matches(PyExc_OverflowError)) throw error;
  refuse_value(name, "beyond the range of floats", "a real number from -1.8e308 to 1.8e308");
}

}  // namespace

bool has_attribute(nb::handle object, const char* name) {
  return find_attribute(object, name).is_valid();
}

nb::object attribute(nb::handle object, const char* name) {
  nb::object value = find_attribute(object, name);
  return value.is_valid() ? value : nb::none();
}

void refuse_type(const std::string& name, nb::handle value, const std::string& accepted) {
  throw nb::type_error((name + " is " + value_text(value) + "; accepted: " + accepted).c_str());
}

void refuse_value(const std::string& name, const std::string& value, const std::string& accepted) {
  throw nb::value_error((name + " is " + value + "; accepted: " + accepted).c_str());
}

std::string shown(double number) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, number).ptr;
  return {text, end};
}

std::string shown(const double* numbers, std::size_t count) {
  std::string text = "[";
  for (std::size_t k = 0; k < count; ++k) text += (k == 0 ? "" : ", ") + shown(numbers[k]);
  return text + ']';
}

std::string shown(const Eigen::Vector3d& vector) {
  return shown(vector.data(), 3);
}

double number(nb::handle value, const char* name) {
  double read = 0;
  if (read_plain(value, read)) return read;
  if (is_number_object(value)) return read_object(value, name);
  const RealArray array(value, name, "a real number");
  if (!array.shape().empty()) refuse_shape(name, array.shape(), "a real number");
  return array.data()[0];
}

double finite_number(nb::handle value, const char* name) {
  const double read = number(value, name);
  if (!std::isfinite(read)) refuse_value(name, shown(read), "a finite number");
  return read;
}

double positive(nb::handle value, const char* name) {
  const double read = number(value, name);
  if (!(read > 0) || !std::isfinite(read)) refuse_value(name, shown(read), "a finite number above 0");
  return read;
}

long long integer(nb::handle value, const char* name, long long least, long long most) {
  const std::string accepted = "an integer from " + std::to_string(least) + " to " + std::to_string(most);
  if (PyBool_Check(value.ptr()) || PyIndex_Check(value.ptr()) == 0) refuse_type(name, value, accepted);
  const nb::object index = nb::steal(PyNumber_Index(value.ptr()));
  if (!index.is_valid()) {
    nb::python_error error;
    if (!error.matches(PyExc_TypeError)) throw error;
    refuse_type(name, value, accepted);  // an array
  }
  int overflow = 0;
  const long long read = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
  if (overflow != 0 || read < least || read > most) refuse_value(name, value_text(index), accepted);
  return read;
}

bool plain_numbers(nb::handle value, double* out, std::size_t count) {
  if (!PyList_CheckExact(value.ptr()) && !PyTuple_CheckExact(value.ptr())) return false;
  if (nb::len(value) != count) return false;
  for (std::size_t k = 0; k < count; ++k) {
    if (!read_plain(value[k], out[k])) return false;
  }
  return true;
}

void numbers(nb::handle value, const char* name, double* out, std::size_t count) {
  if (plain_numbers(value, out, count)) return;
  const std::string accepted = std::to_string(count) + " real numbers";
  const RealArray array(value, name, accepted);
  if (array.shape().size() != 1 || array.shape()[0] != count) refuse_shape(name, array.shape(), accepted);
  std::copy_n(array.data(), count, out);
}

Eigen::Vector3d vector3(nb::handle value, const char* name) {
  Eigen::Vector3d vector;
  numbers(value, name, vector.data(), 3);
  return vector;
}

Eigen::Vector3d finite_vector3(nb::handle value, const char* name) {
  const Eigen::Vector3d vector = vector3(value, name);
  if (!vector.allFinite()) refuse_value(name, shown(vector), "three finite numbers");
  return vector;
}

Eigen::Vector3d direction3(nb::handle value, const char* name) {
  const Eigen::Vector3d vector = vector3(value, name);
  if (!vector.allFinite() || vector.isZero(0)) refuse_value(name, shown(vector), "three finite numbers, not all 0");
  return vector;
}

bool truth(nb::handle value, const std::string& name, const std::string& accepted) {
  const bool is_bool = PyBool_Check(value.ptr()) || nb::isinstance(value, nb::module_::import_("numpy").attr("bool_"));
  if (!is_bool) refuse_type(name, value, accepted);
  return PyObject_IsTrue(value.ptr()) == 1;
}

std::string_view text(nb::handle value, const char* name, const std::string& accepted) {
  std::string_view read;
  if (!nb::isinstance<nb::str>(value) || !nb::try_cast(value, read, false)) refuse_type(name, value, accepted);
  if (read.find('\0') != std::string_view::npos) refuse_value(name, value_text(value), accepted);  // messages end there
  return read;
}

}  // namespace hardbody::python
