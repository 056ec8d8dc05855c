#include "io/csv_table.h"

#include "base/errors.h"
#include "base/number_text.h"
#include "base/suggest.h"
#include "io/text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hardbody {
namespace {

constexpr std::size_t kLongestTable = std::size_t{1} << 28;  ///< bytes

/// Reads one row and the end of its line; quoted fields may contain line breaks.
class RowReader {
 public:
  RowReader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  bool at_end() const { return at_ >= text_.size(); }
  int line() const { return line_; }

  std::vector<std::string> next() {
    std::vector<std::string> row(1);
    while (!at_end()) {
      const char c = text_[at_++];
      if (c == '"') {
        quoted(row.back());
      } else if (c == ',') {
        row.emplace_back();
      } else if (c == '\n') {
        ++line_;
        break;
      } else if (c != '\r') {
        row.back() += c;
      }
    }
    return row;
  }

 private:
  void quoted(std::string& field) {
    const int begin = line_;
    while (!at_end()) {
      const char c = text_[at_++];
      if (c == '\n') ++line_;
      if (c != '"') {
        field += c;
      } else if (!at_end() && text_[at_] == '"') {
        field += text_[at_++];
      } else {
        return;
      }
    }
    throw InputError(fmt::format("{}:{}: a quote is not closed; accepted: comma-separated values", name_, begin));
  }

  std::string_view text_;
  std::string name_;
  std::size_t at_ = 0;
  int line_ = 1;
};

}  // namespace

std::optional<std::size_t> CsvTable::find(std::string_view wanted) const {
  const auto exact = std::find(header.begin(), header.end(), wanted);
  if (exact != header.end()) return static_cast<std::size_t>(exact - header.begin());
  const std::string ending = fmt::format(".{}", wanted);
  std::optional<std::size_t> found;
  for (std::size_t k = 0; k < header.size(); ++k) {
    if (!header[k].ends_with(ending)) continue;
    if (found) return std::nullopt;
    found = k;
  }
  return found;
}

std::size_t CsvTable::column(std::string_view wanted) const {
  if (const auto found = find(wanted)) return *found;
  const std::vector<std::string_view> names(header.begin(), header.end());
  const auto nearest = nearest_name(wanted, names);
  throw InputError(fmt::format("{}: has no column {}{}; accepted: {}", name, one_line(wanted, 60),
                               nearest ? fmt::format(", did you mean {}?", *nearest) : "", fmt::join(header, ", ")));
}

std::optional<double> CsvTable::number(std::size_t row, std::size_t column) const {
  const std::string& field = rows[row][column];
  if (field.empty()) return std::nullopt;
  if (const std::optional<double> value = finite_number(field)) return value;
  throw InputError(fmt::format("{}: {} of row {} is {}; accepted: numbers or empty fields", name, header[column],
                               row + 1, one_line(field, 40)));
}

CsvTable parse_csv(std::string_view text, const std::string& name) {
  CsvTable table;
  table.name = name;
  RowReader reader(text, name);
  if (reader.at_end()) {
    throw InputError(fmt::format("{}: is empty; accepted: comma-separated values with a line of names", name));
  }
  table.header = reader.next();
  while (!reader.at_end()) {
    const int line = reader.line();
    std::vector<std::string> row = reader.next();
    if (row.size() == 1 && row[0].empty()) continue;
    if (row.size() != table.header.size()) {
      throw InputError(fmt::format("{}:{}: has {} fields; accepted: {}, as in the first line", name, line, row.size(),
                                   table.header.size()));
    }
    table.rows.push_back(std::move(row));
    table.lines.push_back(line);
  }
  return table;
}

CsvTable read_csv(const std::filesystem::path& path) {
  return parse_csv(read_file(path, kLongestTable), path.string());
}

}  // namespace hardbody
