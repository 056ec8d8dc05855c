#include "base/console.h"
#include "base/errors.h"
#include "base/number_text.h"
#include "commands/commands.h"
#include "io/csv_table.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "plot/contours.h"
#include "plot/levels.h"
#include "plot/map_svg.h"
#include "registry/key_names.h"
#include "registry/observables.h"
#include "sweep/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

fs::path table_path(const MapArguments& arguments) {
  const fs::path path = arguments.table;
  return fs::is_directory(path) ? path / kSweepTableFile : path;
}

double parse_number(std::string_view text, std::string_view option) {
  if (const std::optional<double> x = finite_number(text)) return *x;
  throw InputError(
      fmt::format("{}: {} is not a number; accepted: numbers with commas between", option, one_line(text, 40)));
}

std::vector<double> parse_levels(std::string_view text) {
  std::vector<double> levels;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    levels.push_back(parse_number(text.substr(begin, comma - begin), "--levels"));
    begin = comma + 1;
  }
  return levels;
}

/// Returns whether a field equals the value in --where: the same text, or the same number (2 and 2.0).
bool is_same(const std::string& field, const std::string& wanted) {
  const std::optional<double> number = finite_number(wanted);
  return field == wanted || (number && finite_number(field) == number);
}

/// Returns the rows for which every --where column=value holds.
std::vector<std::size_t> chosen_rows(const CsvTable& table, const std::vector<std::string>& conditions) {
  std::vector<std::size_t> rows(table.rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = k;
  for (const std::string& condition : conditions) {
    const std::size_t equals = condition.find('=');
    if (equals == std::string::npos) {
      throw InputError(fmt::format("--where {}: is not a condition; accepted: column=value", one_line(condition, 60)));
    }
    const std::size_t column = table.column(std::string_view(condition).substr(0, equals));
    const std::string wanted = condition.substr(equals + 1);
    std::erase_if(rows, [&](std::size_t k) { return !is_same(table.rows[k][column], wanted); });
    if (!rows.empty()) continue;
    throw InputError(fmt::format("--where {}: no row of {} has this value{}; accepted: a value of that column",
                                 condition, table.name,
                                 conditions.size() > 1 ? " and those of the conditions before it" : ""));
  }
  return rows;
}

constexpr const char* kStatusColumn = "status";

/// Returns whether a status is that of an unfinished point in a sweep's table; in other tables `status` may have
/// another meaning.
bool is_unfinished(const std::string& status) {
  constexpr std::array kOthers = {PointStatus::pending, PointStatus::running, PointStatus::stopped,
                                  PointStatus::failed};
  return std::any_of(kOthers.begin(), kOthers.end(), [&](PointStatus s) { return status == to_string(s); });
}

/// Leaves out failed points of a sweep's table, above all unsound ones, whose values are not results. Returns how many
/// of them had values.
std::size_t leave_out_failures(const CsvTable& table, std::vector<std::size_t>& rows,
                               const std::vector<std::size_t>& values) {
  const auto status = std::find(table.header.begin(), table.header.end(), kStatusColumn);
  if (status == table.header.end()) return 0;
  const auto column = static_cast<std::size_t>(status - table.header.begin());
  const auto measured = [&](std::size_t k) {
    return std::any_of(values.begin(), values.end(), [&](std::size_t v) { return !table.rows[k][v].empty(); });
  };
  std::size_t left_out = 0;
  std::erase_if(rows, [&](std::size_t k) {
    if (!is_unfinished(table.rows[k][column])) return false;
    if (measured(k)) ++left_out;
    return true;
  });
  return left_out;
}

/// Returns a coordinate after checking that it can be drawn.
double coordinate(double x, bool log, const std::string& name) {
  if (!log || x > 0) return x;
  throw InputError(fmt::format("{}: has {:g}, which has no logarithm; accepted: values above 0", name, x));
}

/// Columns that the map is made of.
struct Columns {
  std::size_t x;
  std::size_t y;
  std::vector<std::size_t> values;
};

std::vector<Sample> samples_of(const CsvTable& table, const std::vector<std::size_t>& rows, const Columns& columns,
                               std::size_t value, const MapArguments& arguments) {
  std::vector<Sample> samples;
  for (const std::size_t k : rows) {
    const auto x = table.number(k, columns.x);
    const auto y = table.number(k, columns.y);
    const auto v = table.number(k, value);
    if (!x || !y || !v) continue;
    samples.push_back({coordinate(*x, arguments.log_x, arguments.x), coordinate(*y, arguments.log_y, arguments.y), *v});
  }
  return samples;
}

/// Throws unless the samples spread over a plane, which lines need.
void check_spread(const CsvTable& table, const std::vector<Sample>& samples, const std::string& x, const std::string& y,
                  const std::string& value) {
  if (has_cells(lattice_of(samples))) return;
  std::set<std::pair<double, double>> points;
  std::set<double> columns;
  for (const Sample& s : samples) {
    points.emplace(s.x, s.y);
    columns.insert(s.x);
  }
  throw InputError(
      fmt::format("{}: {} is known at {} points with {} values of {}, between which no line can be drawn (as "
                  "for keys that a sweep zips); accepted: at least two neighbouring values of {}, one of them with two "
                  "values of {}",
                  table.name, value, points.size(), columns.size(), x, x, y));
}

std::vector<MapLevel> all_levels(const CsvTable& table, const std::vector<std::size_t>& rows, const Columns& columns,
                                 const MapArguments& arguments) {
  std::vector<MapLevel> all;
  for (std::size_t v = 0; v < columns.values.size(); ++v) {
    const std::vector<Sample> samples = samples_of(table, rows, columns, columns.values[v], arguments);
    if (samples.empty()) {
      throw InputError(
          fmt::format("{}: {} has no values; accepted: a column with values", table.name, arguments.values[v]));
    }
    check_spread(table, samples, arguments.x, arguments.y, arguments.values[v]);
    const std::vector<double> levels =
        arguments.levels.empty() ? chosen_levels(samples) : parse_levels(arguments.levels[v]);
    const MapScales scales{arguments.log_x, arguments.log_y};
    for (MapLevel& level : map_levels(samples, levels, scales)) {
      level.value = table.header[columns.values[v]];
      level.of = v;
      all.push_back(std::move(level));
    }
  }
  return all;
}

/// Returns the marks, open ones for rows that were not equilibrated.
std::vector<MapMark> marks_of(const CsvTable& table, const std::vector<std::size_t>& rows, const Columns& columns) {
  std::vector<MapMark> marks;
  const std::optional<std::size_t> equilibrated = table.find("equilibrated");
  for (const std::size_t k : rows) {
    const auto x = table.number(k, columns.x);
    const auto y = table.number(k, columns.y);
    const bool measured = std::any_of(columns.values.begin(), columns.values.end(),
                                      [&](std::size_t value) { return table.number(k, value).has_value(); });
    if (!x || !y || !measured) continue;
    marks.push_back({*x, *y, equilibrated && table.rows[k][*equilibrated] == "false"});
  }
  return marks;
}

/// Returns the symbol and unit of an observable; the column's name if it is none.
std::string legend_of(const std::string& column) {
  const Observable* known = find_observable(column);
  if (known == nullptr) return column;
  const std::string unit = report_unit(*known);
  const std::string& symbol = known->symbol.empty() ? known->key : known->symbol;
  return unit.empty() ? symbol : fmt::format("{}  [{}]", symbol, unit);
}

constexpr std::string_view kCsvBeginning = "value,level,line,";

/// Returns the lines as CSV, with the names of the two columns of the table.
std::string lines_csv(const Map& map, const std::string& x, const std::string& y) {
  std::string text = fmt::format("{}{},{}\n", kCsvBeginning, x, y);
  for (const MapLevel& level : map.levels) {
    for (std::size_t k = 0; k < level.lines.size(); ++k) {
      for (const PlanePoint& p : level.lines[k]) {
        fmt::format_to(std::back_inserter(text), "{},{:g},{},{:.6g},{:.6g}\n", level.value, level.level, k + 1, p.x,
                       p.y);
      }
    }
  }
  return text;
}

void check(const MapArguments& arguments) {
  if (arguments.values.empty()) throw InputError("--value is not given; accepted: a column, or several");
  if (!arguments.levels.empty() && arguments.levels.size() != arguments.values.size()) {
    throw InputError(
        fmt::format("--levels is given {} times and --value {} times; accepted: levels for each value, or "
                    "for none",
                    arguments.levels.size(), arguments.values.size()));
  }
}

fs::path output(const std::optional<std::string>& wanted, const MapArguments& arguments, const char* extension) {
  if (wanted) return *wanted;
  fs::path path = table_path(arguments);
  return path.parent_path() / fmt::format("map_{}{}", fmt::join(arguments.values, "_"), extension);
}

void print_levels(const Map& map) {
  for (const MapLevel& level : map.levels) {
    std::size_t points = 0;
    for (const ContourLine& line : level.lines) points += line.size();
    console().print(
        fmt::format("  {} = {:g}: {} lines, {} points\n", level.value, level.level, level.lines.size(), points));
  }
}

}  // namespace

int map(const MapArguments& arguments) {
  check(arguments);
  const CsvTable table = read_csv(table_path(arguments));
  Columns columns{table.column(arguments.x), table.column(arguments.y), {}};
  for (const std::string& value : arguments.values) columns.values.push_back(table.column(value));
  std::vector<std::size_t> rows = chosen_rows(table, arguments.where);
  const std::size_t left_out = leave_out_failures(table, rows, columns.values);
  Map map;
  map.x_label = key_label(table.header[columns.x]);
  map.y_label = key_label(table.header[columns.y]);
  for (const std::size_t value : columns.values) map.legend.push_back(legend_of(table.header[value]));
  map.scales = {arguments.log_x, arguments.log_y};
  map.levels = all_levels(table, rows, columns, arguments);
  map.marks = marks_of(table, rows, columns);
  const fs::path svg = output(arguments.out, arguments, ".svg");
  const fs::path csv = output(arguments.csv, arguments, ".csv");
  check_replaceable(svg, "<svg ");
  check_replaceable(csv, kCsvBeginning);
  write_file(svg, map_svg(map));
  write_file(csv, lines_csv(map, table.header[columns.x], table.header[columns.y]));
  console().print(fmt::format("{}, {} written from {} points{}\n", svg.string(), csv.string(), map.marks.size(),
                              left_out > 0 ? fmt::format("; {} left out, whose status is not done", left_out) : ""));
  print_levels(map);
  return 0;
}

}  // namespace hardbody
