#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Table from a file of comma-separated values with one line of names.
struct CsvTable {
  std::string name;  ///< name of the file, for messages
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< rows, each as long as the header
  std::vector<int> lines;                      ///< lines of the file in which the rows begin

  /// Returns the column of this name, or the only one whose name ends in .NAME. Throws InputError.
  std::size_t column(std::string_view wanted) const;
  std::optional<std::size_t> find(std::string_view wanted) const;

  /// Returns the number in a field, nullopt for an empty field; throws InputError for a field that is not a number.
  std::optional<double> number(std::size_t row, std::size_t column) const;
};

/// Reads a table. Throws InputError, `file:line`, for rows that are longer or shorter than the first and quotes that
/// are not closed.
CsvTable read_csv(const std::filesystem::path& path);
CsvTable parse_csv(std::string_view text, const std::string& name);

}  // namespace hardbody
