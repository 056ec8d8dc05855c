#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Table of numbers from a file of observables/.
struct Curves {
  std::string name;                         ///< name of the file, without its extension: "msd"
  std::vector<std::string> columns;         ///< names of the header line, with units: "msd [l^2]"
  std::vector<std::vector<double>> values;  ///< values of each column; NaN: an empty field, a missing value

  std::size_t rows() const { return values.empty() ? 0 : values[0].size(); }
  /// Returns the column of this name, without its unit; nullptr if there is none.
  const std::vector<double>* find(std::string_view column) const;
  /// Returns the unit of a column, the text in brackets.
  static std::string unit(std::string_view column);
  /// Returns the name of a column without its unit.
  static std::string bare_name(std::string_view column);
};

/// Parses a table. Throws InputError, naming the line, for text that is not a table of numbers, an empty text included.
Curves parse_curves(std::string_view text, const std::string& name, const std::string& where);

/// Reads all files of a run's observables/ that exist.
std::vector<Curves> read_curves(const std::filesystem::path& directory);

}  // namespace hardbody
