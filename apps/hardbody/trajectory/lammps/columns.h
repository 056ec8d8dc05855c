#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Splits a line into words.
std::vector<std::string_view> words_of(std::string_view line);

/// Columns of a dump's frame by their names.
struct DumpColumns {
  using Column = std::optional<std::size_t>;

  /// Columns of positions along one axis.
  struct Axis {
    Column wrapped, scaled, unwrapped, unwrapped_scaled, image;
  };

  explicit DumpColumns(std::vector<std::string_view> names);

  std::vector<std::string_view> names;
  std::array<Axis, 3> axes;
  Column id, type, mass, radius, diameter;
  // nullopt if one of them is missing.
  std::optional<std::array<std::size_t, 4>> quaternion;
  std::optional<std::array<std::size_t, 3>> velocity, angular_momentum, angular_velocity, diameters;
  std::optional<std::array<std::size_t, 2>> roundness;  ///< Phi = e2, Theta = e1
  /// Columns that are present and not used, each with advice.
  std::vector<std::string> notices;

  /// Returns whether each axis has a column of unwrapped positions or of images.
  bool unwrapped() const;
  /// Returns whether each axis has a column of unwrapped positions.
  bool unwrapped_columns() const;

 private:
  Column find(std::string_view name) const;
  template <std::size_t n>
  std::optional<std::array<std::size_t, n>> all(const std::array<std::string_view, n>& wanted) const;
  void note_unused();
};

}  // namespace hardbody
