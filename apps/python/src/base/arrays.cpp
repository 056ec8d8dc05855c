#include "base/arrays.h"

#include "base/arguments.h"
#include "base/memory.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <string_view>
#include <type_traits>
#include <utility>

namespace hardbody::python {
namespace {

std::string shape_text(const std::vector<std::size_t>& shape) {
  std::string text = "(";
  for (std::size_t k = 0; k < shape.size(); ++k) text += (k == 0 ? "" : ", ") + std::to_string(shape[k]);
  return text + (shape.size() == 1 ? ",)" : ")");
}

std::vector<std::size_t> shape_of(nb::handle array) {
  std::vector<std::size_t> shape;
  for (const nb::handle extent : nb::cast<nb::tuple>(array.attr("shape"))) {
    shape.push_back(nb::cast<std::size_t>(extent));
  }
  return shape;
}

/// Calls NumPy. Its ValueError, TypeError or MemoryError is raised again with the name of the argument.
template <class Call>
nb::object ask_numpy(const std::string& name, const std::string& accepted, Call call) {
  try {
    return call(nb::module_::import_("numpy"));
  } catch (nb::python_error& error) {
    for (PyObject* const kind : {PyExc_MemoryError, PyExc_ValueError, PyExc_TypeError}) {
      if (!error.matches(kind)) continue;
      const auto why = nb::cast<std::string>(nb::str(error.value()));
      nb::raise_from(error, kind, "%s cannot be read: %s; accepted: %s", name.c_str(), why.c_str(), accepted.c_str());
    }
    throw;
  }
}

/// Returns whether a value is a NumPy array, of no subclass.
bool is_plain_array(nb::handle value) {
  return value.type().is(nb::module_::import_("numpy").attr("ndarray"));
}

/// Returns the array. Throws TypeError unless its numbers are of a kind in `kinds`.
nb::object check_kind(nb::object array, const std::string& name, std::string_view kinds, const std::string& accepted) {
  const nb::object dtype = array.attr("dtype");
  const auto kind = nb::cast<std::string>(dtype.attr("kind"));
  const bool is_empty = nb::cast<std::size_t>(array.attr("size")) == 0;
  // NumPy's array of no numbers has the type of reals.
  if (kinds.find(kind) == std::string_view::npos && !(is_empty && kind == "f")) {
    const auto type = nb::cast<std::string>(nb::str(dtype));
    throw nb::type_error((name + " has dtype " + type + "; accepted: " + accepted).c_str());
  }
  return array;
}

/// Returns whether any element of a masked array is masked.
bool is_masked(nb::handle array) {
  return PyObject_IsTrue(nb::module_::import_("numpy").attr("any")(array.attr("mask")).ptr()) == 1;
}

/// Returns the argument as a NumPy array of numbers of a kind in `kinds`, NumPy's letters.
nb::object as_array(nb::handle value, const std::string& name, std::string_view kinds, const std::string& accepted) {
  if (is_plain_array(value)) return check_kind(nb::borrow(value), name, kinds, accepted);
  if (value.is_none() || PyUnicode_Check(value.ptr())) refuse_type(name, value, accepted);
  if (nb::hasattr(value, "mask") && nb::hasattr(value, "filled") && is_masked(value)) {
    throw nb::type_error((name + " is a masked array; accepted: " + accepted + ", none of them masked").c_str());
  }
  return check_kind(ask_numpy(name, accepted, [&](const nb::module_& numpy) { return numpy.attr("asarray")(value); }),
                    name, kinds, accepted);
}
template <class T>
constexpr const char* dtype_name() {
  if constexpr (std::is_same_v<T, double>) return "float64";
  if constexpr (std::is_same_v<T, std::int64_t>) return "int64";
  if constexpr (std::is_same_v<T, std::int32_t>) return "int32";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "uint8";
  if constexpr (std::is_same_v<T, bool>) return "bool";
}

/// Replaces an array by one of contiguous T unless it is one; returns its memory.
template <class T>
const T* make_contiguous(nb::object& array, const std::string& name, const std::string& accepted) {
  nb::ndarray<const T, nb::c_contig, nb::device::cpu> view;
  if (nb::try_cast(array, view, false) && reinterpret_cast<std::uintptr_t>(view.data()) % alignof(T) == 0) {
    return view.data();
  }
  // ascontiguousarray would make one dimension of none.
  array = ask_numpy(name, accepted, [&](const nb::module_& numpy) {
    return numpy.attr("require")(array, dtype_name<T>(), nb::str("CA"));
  });
  return nb::cast<nb::ndarray<const T, nb::c_contig, nb::device::cpu>>(array).data();
}

/// Returns the number of rows. Throws ValueError unless the shape is (rows, columns), or (rows,) for `columns` 1.
std::size_t rows_of(const std::vector<std::size_t>& shape, std::size_t columns, const std::string& name,
                    const std::string& accepted) {
  if (shape == std::vector<std::size_t>{0}) return 0;
  const bool is_right = columns == 1 ? shape.size() == 1 : shape.size() == 2 && shape[1] == columns;
  if (!is_right) refuse_shape(name, shape, accepted);
  return shape[0];
}

std::string wanted(const char* numbers, std::size_t columns) {
  return std::string(numbers) + " of shape (rows," + (columns == 1 ? ")" : ' ' + std::to_string(columns) + ')');
}

constexpr std::size_t kMostBytes = std::size_t{1} << 46;

/// Returns NumPy's uninitialised array. Throws MemoryError, naming what does not fit.
nb::object empty_array(const nb::tuple& extents, const char* type, const std::string& what) {
  try {
    return nb::module_::import_("numpy").attr("empty")(extents, type);
  } catch (nb::python_error& error) {
    // NumPy's ValueError: more bytes than there are addresses.
    if (!error.matches(PyExc_MemoryError) && !error.matches(PyExc_ValueError)) throw;
    nb::raise_from(error, PyExc_MemoryError, "%s does not fit into memory", what.c_str());
  }
}

/// Returns memory that is kept when it is dropped; null, after giving back all that is kept, if no more is available.
std::unique_ptr<KeptMemory> kept_memory(std::size_t bytes) {
  try {
    return std::make_unique<KeptMemory>(bytes);
  } catch (const std::bad_alloc&) {
    release_kept_memory();
    return nullptr;
  }
}

/// Returns an array in such memory.
template <class T>
NewArray<T> kept_array(const std::vector<std::size_t>& shape, std::unique_ptr<KeptMemory> memory) {
  T* const data = static_cast<T*>(memory->data());
  const nb::capsule owner(memory.release(), [](void* dropped) noexcept { delete static_cast<KeptMemory*>(dropped); });
  return {nb::cast(nb::ndarray<nb::numpy, T>(data, shape.size(), shape.data(), owner)), data};
}

}  // namespace

void refuse_shape(const std::string& name, const std::vector<std::size_t>& shape, const std::string& accepted) {
  throw nb::value_error((name + " has shape " + shape_text(shape) + "; accepted: " + accepted).c_str());
}

std::string entry(const std::string& name, std::size_t row) {
  return name + '[' + std::to_string(row) + ']';
}

void check_rows(const std::string& name, std::size_t rows, const std::string& other, std::size_t wanted) {
  if (rows == wanted) return;
  throw nb::value_error((name + " has " + std::to_string(rows) + " rows; accepted: as many as " + other +
                         ", which has " + std::to_string(wanted))
                            .c_str());
}

RealArray::RealArray(nb::handle value, const std::string& name, const std::string& accepted)
    : owner_(as_array(value, name, "fiu", accepted)), shape_(shape_of(owner_)) {
  data_ = make_contiguous<double>(owner_, name, accepted);
}

RealRows::RealRows(nb::handle value, const std::string& name, std::size_t columns)
    : name_(name), array_(value, name, wanted("real numbers", columns)), columns_(columns) {
  rows_ = rows_of(array_.shape(), columns, name, wanted("real numbers", columns));
}

Eigen::Vector3d RealRows::finite_vector(std::size_t row) const {
  const Eigen::Vector3d vector = Eigen::Vector3d::Map((*this)[row]);
  if (!vector.allFinite()) {
    refuse_value(entry(name_, row), python::shown(vector), "finite numbers");
  }
  return vector;
}

IndexRows::IndexRows(nb::handle value, const std::string& name, std::size_t columns) : name_(name), columns_(columns) {
  const std::string accepted = wanted("integers", columns);
  owner_ = as_array(value, name, "iu", accepted);
  rows_ = rows_of(shape_of(owner_), columns, name, accepted);
  is_unsigned_ = nb::cast<std::string>(owner_.attr("dtype").attr("kind")) == "u";
  data_ = make_contiguous<std::int64_t>(owner_, name, accepted);
}

void IndexRows::refuse(std::size_t row, std::size_t column, std::size_t index, std::size_t count,
                       const char* indexed) const {
  const std::string entry = columns_ == 1 ? std::to_string(row) : std::to_string(row) + ", " + std::to_string(column);
  const std::string accepted =
      count == 0 ? std::string("none, there are no ") + indexed : "0 to " + std::to_string(count - 1);
  const std::string value = is_unsigned_ ? std::to_string(index) : std::to_string(static_cast<std::int64_t>(index));
  refuse_value(name_ + '[' + entry + ']', value, accepted);
}

template <class T>
NewArray<T> new_array(const std::vector<std::size_t>& shape) {
  std::size_t size = 1;
  bool overflows = false;
  for (const std::size_t extent : shape) overflows |= __builtin_mul_overflow(size, extent, &size);
  if (!overflows && size >= kLeastKept / sizeof(T) && size <= kMostBytes / sizeof(T)) {
    if (auto memory = kept_memory(size * sizeof(T))) return kept_array<T>(shape, std::move(memory));
  }
  nb::list extents;
  for (const std::size_t extent : shape) extents.append(extent);
  nb::object array = empty_array(nb::tuple(extents), dtype_name<T>(), "a result of shape " + shape_text(shape));
  T* const data = nb::cast<nb::ndarray<T, nb::c_contig, nb::device::cpu>>(array).data();
  return {std::move(array), data};
}

template NewArray<double> new_array(const std::vector<std::size_t>& shape);
template NewArray<std::int32_t> new_array(const std::vector<std::size_t>& shape);
template NewArray<std::int64_t> new_array(const std::vector<std::size_t>& shape);
template NewArray<std::uint8_t> new_array(const std::vector<std::size_t>& shape);
template NewArray<bool> new_array(const std::vector<std::size_t>& shape);

nb::object array_of(std::span<const double> numbers) {
  NewArray<double> made = new_array<double>({numbers.size()});
  std::copy(numbers.begin(), numbers.end(), made.data);
  return made.array;
}

nb::object array_of(const Eigen::Vector3d& vector) {
  return array_of(std::span(vector.data(), 3));
}

nb::object array_of(const Eigen::Matrix3d& matrix) {
  NewArray<double> made = new_array<double>({3, 3});
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor>::Map(made.data) = matrix;
  return made.array;
}

}  // namespace hardbody::python
