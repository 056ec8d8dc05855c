#pragma once

#include "base/errors.h"
#include "base/shapes.h"
#include "trajectory/frame.h"
#include "trajectory/gsd/container.h"
#include "trajectory/gsd/schema.h"
#include "trajectory/gsd/type_shapes.h"

#include <ed/system.h>

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

/// Name of an array, of the schema or another.
struct ArrayName {
  ArrayName(gsd::Name name) : text(gsd::kNameTexts[name]) {}  // NOLINT(google-explicit-constructor)
  explicit ArrayName(const char* name) : text(name) {}

  const char* text;
};

/// Shapes that a file's frames have shown, as hulls of many points take their time.
struct ShapesOfFile {
  std::map<std::string, std::optional<TypeShape>> rows;          ///< shapes by rows of particles/type_shapes
  std::map<std::string, std::optional<ed::BodyShape>> own_rows;  ///< shapes by rows of this program's polytopes
  std::optional<std::vector<ed::Species>> species;               ///< species of frame 0
};

/// Reader of one frame of a file.
class FrameReader {
 public:
  FrameReader(const GsdFile& file, std::uint64_t k, bool exact, ShapesOfFile& shapes)
      : file_(file), k_(k), exact_(exact), shapes_(shapes) {}

  /// Reads a frame without its exact state.
  Frame read();
  /// Reads the exact state of the frame.
  ed::System read_exact();

 private:
  InputError bad(const std::string& what, const std::string& accepted) const {
    return InputError(fmt::format("{}: frame {}: {}; accepted: {}", file_.name(), k_, what, accepted));
  }

  /// Returns the array of this frame. If it has none: that of frame 0, provided that has as many rows; nullptr: the
  /// default.
  const GsdChunk* find(ArrayName name, std::uint64_t rows, std::uint32_t columns, GsdType type) const;
  /// Returns whether the file contains this quantity for this frame. After frame 0 an absent array is that of frame 0
  /// only if some later frame has such an array: otherwise the program may just have stopped writing it.
  bool knows(ArrayName name) const { return file_.find(k_, name.text) != nullptr || file_.stored_later(name.text); }
  /// Returns the numbers of an array; empty: the default.
  template <class T>
  std::vector<T> numbers(ArrayName name, std::uint64_t rows, std::uint32_t columns) const;
  /// Returns the numbers of an array, which must be finite; empty: the default.
  template <class T>
  std::vector<double> finite(ArrayName name, std::uint64_t rows, std::uint32_t columns) const;
  template <class T>
  T scalar(ArrayName name, T missing) const;
  /// Returns a number that this frame itself has logged: the schema has no defaults for log/. NaN if there is none.
  double logged(gsd::Name name) const {
    constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
    return file_.find(k_, gsd::kNameTexts[name]) != nullptr ? scalar(name, kMissing) : kMissing;
  }
  std::vector<std::string> texts(ArrayName name) const;
  std::vector<double> exact(gsd::Name name, std::uint64_t rows, std::uint32_t columns) const;

  void read_box(Frame& frame) const;
  void read_types(Frame& frame) const;
  void read_bodies(Frame& frame) const;
  void read_motion(Frame& frame) const;
  void read_orientations(Frame& frame) const;
  void read_diameters(Frame& frame) const;
  void move_to_shapes(Frame& frame) const;
  ShapeNumbers shape_numbers(const double* row, std::uint32_t columns) const;
  std::optional<ed::BodyShape> own_shape(const std::string& row, const ed::BodyShape& known) const;
  std::vector<ed::Species> read_species() const;

  const GsdFile& file_;
  std::uint64_t k_;
  bool exact_;  ///< whether frames contain their state in doubles
  ShapesOfFile& shapes_;
};

}  // namespace hardbody
