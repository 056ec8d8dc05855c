#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// A file of observables/: numbers in columns.
struct Curves {
  std::string name;                         ///< of the file, without its ending: "msd"
  std::vector<std::string> columns;         ///< of the header line, with units: "msd [l^2]"
  std::vector<std::vector<double>> values;  ///< of each column; NaN: an empty field, a missing value

  std::size_t rows() const { return values.empty() ? 0 : values[0].size(); }
  /// The column of that name, without its unit; nullptr: there is none.
  const std::vector<double>* find(std::string_view column) const;
  /// The unit of a column: what stands in brackets.
  static std::string unit(std::string_view column);
  /// Its name without the unit.
  static std::string bare_name(std::string_view column);
};

/// Throws InputError, naming the line, for what is not a table of numbers. An empty list where there is no text.
Curves parse_curves(std::string_view text, const std::string& name, const std::string& where);

/// Those files of a run directory that are there.
std::vector<Curves> read_curves(const std::filesystem::path& directory);

}  // namespace hardbody
