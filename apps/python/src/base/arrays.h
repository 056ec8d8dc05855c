#pragma once

/// NumPy arrays as arguments and results.

#include <nanobind/nanobind.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace hardbody::python {

namespace nb = nanobind;

/// Throws ValueError "<name> has shape <shape>; accepted: <accepted>".
[[noreturn]] void refuse_shape(const std::string& name, const std::vector<std::size_t>& shape,
                               const std::string& accepted);

/// Returns an entry as messages name it: "positions[3]".
std::string entry(const std::string& name, std::size_t row);

/// Throws ValueError, naming both, unless an argument has as many rows as the argument `other`.
void check_rows(const std::string& name, std::size_t rows, const std::string& other, std::size_t wanted);

/// Array of real numbers of any shape, contiguous, kept alive: the argument's own memory if it is of that form, else a
/// copy. Other threads may change the numbers while they are read, never their count.
class RealArray {
 public:
  /// Reads anything that numpy.asarray takes. Throws TypeError unless its numbers are real (no bool, no complex),
  /// ValueError if it has no rectangular shape, MemoryError if a copy does not fit.
  RealArray(nb::handle value, const std::string& name, const std::string& accepted);

  const std::vector<std::size_t>& shape() const { return shape_; }
  const double* data() const { return data_; }

 private:
  nb::object owner_;
  std::vector<std::size_t> shape_;
  const double* data_;
};

/// Rows of real numbers, an array of shape (rows, columns).
class RealRows {
 public:
  /// Reads an array. Throws as RealArray, and ValueError for another shape; empty sequences are no rows.
  RealRows(nb::handle value, const std::string& name, std::size_t columns);

  std::size_t size() const { return rows_; }
  const double* operator[](std::size_t row) const { return array_.data() + row * columns_; }

  /// Returns three numbers of a row, the first or those from `column` on. Throws ValueError, naming the row, unless
  /// they are finite.
  Eigen::Vector3d finite_vector(std::size_t row) const;

  const std::string& name() const { return name_; }

 private:
  std::string name_;
  RealArray array_;
  std::size_t columns_;
  std::size_t rows_;
};

/// Indices, an array of shape (rows,) or, with `columns` > 1, (rows, columns).
class IndexRows {
 public:
  /// Reads an array. Throws TypeError unless its numbers are integers, ValueError for another shape; empty sequences
  /// are no rows.
  IndexRows(nb::handle value, const std::string& name, std::size_t columns);

  std::size_t size() const { return rows_; }

  /// Returns an index that may be out of range.
  std::size_t unchecked(std::size_t row, std::size_t column) const {
    return static_cast<std::size_t>(static_cast<const volatile std::int64_t*>(data_)[row * columns_ + column]);
  }

  /// Returns an index below `count`, of what `indexed` names. Throws ValueError, naming the entry, if it is not. Reads
  /// memory once, so that no other thread can change an index after its check.
  std::size_t at(std::size_t row, std::size_t column, std::size_t count, const char* indexed = "bodies") const {
    const std::size_t index = unchecked(row, column);
    if (index >= count) refuse(row, column, index, count, indexed);
    return index;
  }

  /// Throws ValueError, naming the entry, unless both indices of a row, which have been read, are below `count`.
  void check(std::size_t row, std::size_t first, std::size_t second, std::size_t count) const {
    if (first >= count) refuse(row, 0, first, count);
    if (second >= count) refuse(row, 1, second, count);
  }

 private:
  [[noreturn]] void refuse(std::size_t row, std::size_t column, std::size_t index, std::size_t count,
                           const char* indexed = "bodies") const;

  std::string name_;
  nb::object owner_;
  bool is_unsigned_;  ///< whether the integers were, so that those from 2^63 on are not negative
  std::size_t columns_;
  std::size_t rows_;
  const std::int64_t* data_;
};

/// New NumPy array, to be filled.
template <class T>
struct NewArray {
  nb::object array;
  T* data;
};

/// Returns a new, uninitialised array. Memory of large arrays that have been dropped is used again (memory.h). T is one
/// of double, std::int32_t, std::int64_t, std::uint8_t, bool. Throws
/// MemoryError, naming the shape.
template <class T>
NewArray<T> new_array(const std::vector<std::size_t>& shape);

/// Returns a new array of one dimension with these numbers.
nb::object array_of(std::span<const double> numbers);
/// Overload for a vector.
nb::object array_of(const Eigen::Vector3d& vector);
/// Overload for a matrix, shape (3, 3), row by row.
nb::object array_of(const Eigen::Matrix3d& matrix);

}  // namespace hardbody::python
