#pragma once

/// Arguments of Python functions as C++ values. Messages name the argument, what it is and what is accepted: TypeError
/// for a value of the wrong kind, ValueError for one out of range.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace hardbody::python {

namespace nb = nanobind;

/// Throws TypeError "<name> is <value>; accepted: <accepted>".
[[noreturn]] void refuse_type(const std::string& name, nb::handle value, const std::string& accepted);

/// Throws ValueError "<name> is <value>; accepted: <accepted>".
[[noreturn]] void refuse_value(const std::string& name, const std::string& value, const std::string& accepted);

/// Returns a number in the shortest form that reads back to the same double.
std::string shown(double number);

/// Returns numbers as a list: "[1, 2.5, 3]".
std::string shown(const double* numbers, std::size_t count);
/// Overload for a vector.
std::string shown(const Eigen::Vector3d& vector);

/// Returns whether an object has an attribute. Other exceptions than AttributeError are passed on.
bool has_attribute(nb::handle object, const char* name);

/// Returns an attribute, as has_attribute looks for it; None if there is none.
nb::object attribute(nb::handle object, const char* name);

/// Returns a real number, of any class that has __float__ but bool and str; it may be infinite or NaN.
double number(nb::handle value, const char* name);

/// Returns a finite real number.
double finite_number(nb::handle value, const char* name);

/// Returns a finite number above 0.
double positive(nb::handle value, const char* name);

/// Returns an integer within [least, most].
long long integer(nb::handle value, const char* name, long long least, long long most);

/// Reads a list or tuple of `count` floats and ints, for which NumPy would take a microsecond; false for anything else.
bool plain_numbers(nb::handle value, double* out, std::size_t count);

/// Reads `count` numbers from a sequence or a one-dimensional array.
void numbers(nb::handle value, const char* name, double* out, std::size_t count);

/// Returns three numbers; they may be infinite or NaN.
Eigen::Vector3d vector3(nb::handle value, const char* name);

/// Returns three finite numbers.
Eigen::Vector3d finite_vector3(nb::handle value, const char* name);

/// Returns a finite vector that is not zero.
Eigen::Vector3d direction3(nb::handle value, const char* name);

/// Returns a bool, Python's or NumPy's.
bool truth(nb::handle value, const std::string& name, const std::string& accepted = "True or False");

/// Returns the text of a string.
std::string_view text(nb::handle value, const char* name, const std::string& accepted);

/// Returns the enumerator whose to_string is the text given.
template <class Enum, std::size_t n>
Enum choice(nb::handle value, const char* name, const std::array<Enum, n>& options) {
  std::string accepted;
  for (const Enum option : options) accepted += std::string(accepted.empty() ? "\"" : ", \"") + to_string(option) + '"';
  const std::string_view given = text(value, name, accepted);
  for (const Enum option : options) {
    if (given == to_string(option)) return option;
  }
  refuse_value(name, '"' + std::string(given) + '"', accepted);
}

/// Conversion of a value to a variant of bound classes.
template <class Variant>
struct OneOf;

template <class... T>
struct OneOf<std::variant<T...>> {
  using Variant = std::variant<T...>;

  /// Returns whether the value is of one of the classes.
  static bool holds(nb::handle value) { return (nb::isinstance<T>(value) || ...); }

  /// Returns a copy of the object inside. Throws TypeError if the value is of none of the classes; its message lists
  /// them, and `others` after them.
  static Variant from(nb::handle value, const std::string& name, const std::string& others = "") {
    std::optional<Variant> found;
    if (!(put<T>(value, found) || ...)) refuse_type(name, value, accepted() + others);
    return *std::move(found);
  }

 private:
  template <class U>
  static bool put(nb::handle value, std::optional<Variant>& out) {
    U* found = nullptr;
    if (!nb::try_cast(value, found, false) || found == nullptr) return false;
    out.emplace(*found);
    return true;
  }

  template <class U>
  static void name_class(std::string& names) {
    const nb::handle type = nb::type<U>();
    if (!type.is_valid()) return;  // not bound
    names += std::string(names.empty() ? "" : ", ") + nb::cast<std::string>(type.attr("__name__"));
  }

  static std::string accepted() {
    std::string names;
    (name_class<T>(names), ...);
    return names;
  }
};

/// Returns the object of a bound class. Throws TypeError if the value is of another class.
template <class T>
T& instance(nb::handle value, const char* name) {
  T* found = nullptr;
  if (nb::try_cast(value, found, false) && found != nullptr) return *found;
  refuse_type(name, value, nb::cast<std::string>(nb::type<T>().attr("__name__")));
}

}  // namespace hardbody::python
