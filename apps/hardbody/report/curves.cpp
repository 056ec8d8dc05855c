#include "report/curves.h"

#include "base/errors.h"
#include "base/number_text.h"
#include "io/csv_table.h"
#include "io/text_file.h"
#include "registry/curves.h"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <utility>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestFile = std::size_t{1} << 26;

}  // namespace

const std::vector<double>* Curves::find(std::string_view column) const {
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (bare_name(columns[k]) == column) return &values[k];
  }
  return nullptr;
}

std::string Curves::unit(std::string_view column) {
  const std::size_t open = column.find(" [");
  if (open == std::string_view::npos || !column.ends_with(']')) return "";
  return std::string(column.substr(open + 2, column.size() - open - 3));
}

std::string Curves::bare_name(std::string_view column) {
  return std::string(column.substr(0, column.find(" [")));
}

Curves parse_curves(std::string_view text, const std::string& name, const std::string& where) {
  if (text.find_first_not_of("\r\n") == std::string_view::npos || text.find('\0') != std::string_view::npos) {
    throw InputError(
        fmt::format("{}: has no header line of columns; accepted: a CSV file that a run has written", where));
  }
  CsvTable table = parse_csv(text, where);
  Curves curves{name, std::move(table.header), {}};
  curves.values.resize(curves.columns.size());
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    for (std::size_t k = 0; k < curves.columns.size(); ++k) {
      const std::string& field = table.rows[row][k];
      const std::optional<double> value =
          field.empty() ? std::numeric_limits<double>::quiet_NaN() : number_or_nan(field);
      if (!value) {
        throw InputError(fmt::format("{}:{}: \"{}\" is not a number; accepted: a number or nothing", where,
                                     table.lines[row], one_line(field, 40)));
      }
      curves.values[k].push_back(*value);
    }
  }
  return curves;
}

std::vector<Curves> read_curves(const fs::path& directory) {
  std::vector<Curves> all;
  for (const CurveFile& file : curve_files()) {
    const fs::path path = directory / file.path();
    if (!fs::exists(path)) continue;
    all.push_back(parse_curves(read_file(path, kLongestFile), file.name, path.string()));
    for (const std::string& column : required_columns(file)) {
      if (all.back().find(column) == nullptr) {
        throw InputError(
            fmt::format("{}:1: has no column {}; accepted: a CSV file that a run has written", path.string(), column));
      }
    }
  }
  return all;
}

}  // namespace hardbody
