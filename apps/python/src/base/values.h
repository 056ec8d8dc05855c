#pragma once

/// Pickling, copying and comparison of plain results, by their members.

#include "base/arguments.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <tuple>
#include <type_traits>
#include <typeinfo>
#include <utility>

namespace hardbody::python {

/// Returns a member's value as pickles have it.
template <class M>
nb::object to_state(const M& value) {
  if constexpr (std::is_enum_v<M>) {
    return nb::cast(static_cast<int>(value));
  } else {
    return nb::cast(value);
  }
}

/// Overload for a matrix: a tuple of its elements.
template <int rows, int columns>
nb::object to_state(const Eigen::Matrix<double, rows, columns>& value) {
  nb::list list;
  for (const double x : value.reshaped()) list.append(x);
  return nb::tuple(list);
}

/// Reads a member. Throws TypeError for another state.
template <class M>
void from_state(nb::handle state, M& out) {
  try {
    if constexpr (std::is_enum_v<M>) {
      out = static_cast<M>(nb::cast<int>(state));
    } else {
      out = nb::cast<M>(state);
    }
  } catch (const std::bad_cast&) {
    refuse_type("state", state, "what __getstate__ returns");
  }
}

template <int rows, int columns>
void from_state(nb::handle state, Eigen::Matrix<double, rows, columns>& out) {
  numbers(state, "state", out.data(), static_cast<std::size_t>(out.size()));
}

/// Returns whether two members are the same; NaN is the same as NaN.
template <class M>
bool same(const M& a, const M& b) {
  if constexpr (std::is_floating_point_v<M>) {
    return a == b || (std::isnan(a) && std::isnan(b));
  } else if constexpr (std::is_arithmetic_v<M> || std::is_enum_v<M>) {
    return a == b;
  } else {
    return nb::cast(a).equal(nb::cast(b));
  }
}

template <int rows, int columns>
bool same(const Eigen::Matrix<double, rows, columns>& a, const Eigen::Matrix<double, rows, columns>& b) {
  for (Eigen::Index k = 0; k < a.size(); ++k) {
    if (!same(a(k), b(k))) return false;
  }
  return true;
}

/// Defines == of a class, by a function of two values; its objects are unhashable then.
template <class T, class Equal>
void bind_equality(nb::class_<T>& type, Equal equal) {
  type.def(
      "__eq__",
      [equal](const T& value, nb::handle other) {
        T* found = nullptr;
        return nb::try_cast(other, found, false) && found != nullptr && equal(value, *found);
      },
      nb::arg("other").none(), nb::sig("def __eq__(self, other: typing.Any, /) -> bool"));
  type.attr("__hash__") = nb::none();
}

/// Defines pickling by __getstate__ and __setstate__, of every protocol: Python's own way knows no protocol below 2.
template <class T>
void bind_reduce(nb::class_<T>& type) {
  type.def(
      "__reduce__",
      [](nb::handle self) {
        const nb::object construct = nb::module_::import_("copyreg").attr("__newobj__");
        return nb::make_tuple(construct, nb::make_tuple(self.type()), self.attr("__getstate__")());
      },
      nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
}

/// Defines pickling, copying and == of a class whose value is that of these members: pointers to them, or functions
/// that return references to them.
template <class T, class... Member>
void bind_value(nb::class_<T>& type, Member... members) {
  const std::tuple<Member...> all{members...};
  type.def(
          "__getstate__",
          [all](const T& value) {
            return std::apply([&](auto... m) { return nb::make_tuple(to_state(std::invoke(m, value))...); }, all);
          },
          nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__",
          [all](T& self, const nb::tuple& state) {
            if (state.size() != sizeof...(Member)) {
              refuse_value("size of the state", std::to_string(state.size()), std::to_string(sizeof...(Member)));
            }
            T value{};
            std::size_t k = 0;
            std::apply([&](auto... m) { (from_state(state[k++], std::invoke(m, value)), ...); }, all);
            new (&self) T(std::move(value));
          },
          nb::sig("def __setstate__(self, state: tuple[typing.Any, ...], /) -> None"));
  bind_reduce(type);
  bind_equality(type, [all](const T& a, const T& b) {
    return std::apply([&](auto... m) { return (same(std::invoke(m, a), std::invoke(m, b)) && ...); }, all);
  });
}

/// Defines that objects of a class cannot be pickled or copied: TypeError "<what>; accepted: <instead>".
template <class T>
void refuse_pickling(nb::class_<T>& type, const char* what, const char* instead) {
  const std::string message = std::string(what) + " cannot be pickled or copied; accepted: " + instead;
  type.def(
      "__reduce_ex__",
      [message](const T& /*value*/, nb::handle /*protocol*/) -> nb::tuple { throw nb::type_error(message.c_str()); },
      nb::arg("protocol").none(),
      nb::sig("def __reduce_ex__(self, protocol: typing.SupportsIndex, /) -> typing.NoReturn"));
}

}  // namespace hardbody::python
