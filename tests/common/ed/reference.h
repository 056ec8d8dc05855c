#pragma once

/// Tables of tests/reference.

#include <cmath>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ed_test {

/// File of comma-separated values: comments begin with '#', the first other line names the columns. Names may be in
/// quotes; commas within quotes do not separate.
class ReferenceTable {
 public:
  explicit ReferenceTable(const std::string& file) : file_(file) {
    std::ifstream in(std::string(HARDBODY_REFERENCE_DIR) + "/" + file);
    if (!in) throw std::runtime_error("cannot read the reference file " + file);
    for (std::string line; std::getline(in, line);) {
      if (line.empty() || line[0] == '#') continue;
      if (columns_.empty()) {
        columns_ = split(line);
      } else {
        rows_.push_back(split(line));
      }
    }
  }

  std::size_t size() const { return rows_.size(); }

  const std::string& text(std::size_t row, const std::string& column) const { return rows_.at(row).at(index(column)); }
  double value(std::size_t row, const std::string& column) const { return std::stod(text(row, column)); }

  /// Returns the value in the one row whose key columns have these values (to the six digits of the tables).
  double at(std::initializer_list<std::pair<std::string, double>> keys, const std::string& column) const {
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      bool match = true;
      for (const auto& [key, wanted] : keys) match = match && std::abs(value(row, key) - wanted) < 1e-5;
      if (match) return value(row, column);
    }
    throw std::runtime_error(file_ + " has no such row");
  }

 private:
  static std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        fields.emplace_back();
      } else if (c != '\r') {
        fields.back() += c;
      }
    }
    return fields;
  }

  std::size_t index(const std::string& column) const {
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      if (columns_[k] == column) return k;
    }
    throw std::runtime_error(file_ + " has no column " + column);
  }

  std::string file_;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace ed_test
