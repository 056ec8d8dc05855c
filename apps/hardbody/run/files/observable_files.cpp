#include "run/files/observable_files.h"

#include "registry/observables.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace hardbody {
namespace {

void add_row(std::string& text, const std::vector<double>& values) {
  const char* separator = "";
  for (const double value : values) {
    text += separator;
    if (std::isfinite(value)) fmt::format_to(std::back_inserter(text), "{}", value);
    separator = ",";
  }
  text += '\n';
}

/// Whether the axes of these bodies are correlated each by itself.
bool has_axes(const ed::Correlations& correlations) {
  return !correlations.lags.empty() && std::isfinite(correlations.lags[0].c2_axis[0].value);
}

/// All bodies, then, where there are several species, each.
std::vector<const ed::GroupResults*> parts_of(const ed::Results& results) {
  std::vector<const ed::GroupResults*> parts = {&results};
  if (results.groups.size() > 1) {
    for (const ed::GroupResults& group : results.groups) parts.push_back(&group);
  }
  return parts;
}

/// A column of the file: one of a registered column, of one part or of two species.
struct PartColumn {
  const Column* column;
  const ed::Correlations* part;
  std::size_t k;  ///< axis, wave number or lag
  std::string name;
  const ed::CrossStructure* cross = nullptr;

  ed::Estimate at(std::size_t row) const {
    return cross != nullptr ? column->cross(*cross, row) : column->value(*part, row, k);
  }
  /// Returns the value at lag 0; none for displacements and orientations, which need none.
  ed::Estimate at_zero() const {
    return column->at_zero != nullptr && part != nullptr ? part->*column->at_zero : ed::Estimate{};
  }
};

void add_columns(const Column& column, const ed::Correlations& part, const std::string& name,
                 std::vector<PartColumn>& list) {
  switch (column.split) {
    case Split::none:
      list.push_back({&column, &part, 0, name});
      return;
    case Split::axes:
      for (std::size_t k = 0; k < kBodyAxes.size() && has_axes(part); ++k) {
        list.push_back({&column, &part, k, fmt::format("{}_{}", name, kBodyAxes[k])});
      }
      return;
    case Split::edges:
      for (std::size_t k = 0; k < kBodyAxes.size(); ++k) {
        list.push_back({&column, &part, k, fmt::format("{}_{}", name, kBodyAxes[k])});
      }
      return;
    case Split::wave_numbers:
      for (std::size_t k = 0; !part.lags.empty() && k < part.lags[0].f_self.size(); ++k) {
        list.push_back({&column, &part, k, fmt::format("{}_q{}", name, k + 1)});
      }
      return;
    case Split::collective:
      for (std::size_t k = 0; !part.lags.empty() && k < part.lags[0].f_collective.size(); ++k) {
        list.push_back({&column, &part, k, fmt::format("{}_q{}", name, k + 1)});
      }
      return;
    case Split::lags:
      for (std::size_t k = 0; k < part.displacement_lags.size(); ++k) {
        list.push_back({&column, &part, k, fmt::format("{}_t{}", name, k + 1)});
      }
      return;
  }
}

std::vector<PartColumn> columns_of(const CurveFile& file, const ed::Results& results) {
  std::vector<PartColumn> list;
  const std::vector<const ed::GroupResults*> parts = parts_of(results);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (const Column& column : file.columns) {
      if (p > 0 && column.of_orientation && !parts[p]->oriented) continue;
      add_columns(column, *parts[p], p == 0 ? column.name : fmt::format("{}_{}", column.name, p), list);
    }
  }
  for (const ed::CrossStructure& cross : results.crosses) {
    const auto is_oriented = [&](int group) { return results.groups[static_cast<std::size_t>(group)].oriented; };
    for (const Column& column : file.columns) {
      if (!column.cross || (column.of_orientation && !(is_oriented(cross.a) && is_oriented(cross.b)))) continue;
      list.push_back({&column, nullptr, 0, fmt::format("{}_{}_{}", column.name, cross.a + 1, cross.b + 1), &cross});
    }
  }
  return list;
}

/// The first column.
std::vector<double> abscissae(Rows rows, const ed::Results& results) {
  std::vector<double> list;
  if (rows == Rows::lags) {
    for (const ed::LagRow& row : results.lags) list.push_back(row.lag);
  } else if (rows == Rows::pairs) {
    for (const ed::PairRow& row : results.pairs) list.push_back(row.r);
  } else if (rows == Rows::displacements) {
    for (const ed::DisplacementRow& row : results.displacements) list.push_back(row.r);
  } else {
    for (const ed::WaveRow& row : results.structure) list.push_back(row.q);
  }
  return list;
}

/// Returns the table of rows that are told by columns of their own: blocks of the run, Bragg peaks.
template <class Column, class Row>
CurveTable table_of(const std::vector<Column>& columns, const std::vector<Row>& rows) {
  CurveTable table;
  for (const Column& c : columns) {
    table.columns.push_back(c.name);
    table.units.push_back(c.unit);
  }
  for (const Row& row : rows) {
    std::vector<double>& values = table.rows.emplace_back();
    for (const Column& c : columns) values.push_back(c.value(row));
  }
  return table;
}

/// The numbers of summary.json: of all bodies, species 0, then of each.
CurveTable species_table(const ed::Results& results) {
  CurveTable table;
  table.columns.emplace_back("species");
  table.units.emplace_back("1");
  const std::vector<const ed::GroupResults*> parts = parts_of(results);
  for (std::size_t p = 0; p < parts.size(); ++p) table.rows.push_back({static_cast<double>(p)});
  for (const Observable* o : observables_by(&Places::summary)) {
    if (!is_number(*o) || numbers_of(*o, {results.groups[0]}).empty()) continue;
    table.columns.insert(table.columns.end(), {o->key, o->key + "_error"});
    table.units.insert(table.units.end(), {o->unit, o->unit});
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const ed::Estimate e = numbers_of(*o, {*parts[p]})[0];
      table.rows[p].insert(table.rows[p].end(), {e.value, e.error});
    }
  }
  return table;
}

/// Names the first column: "t", "l sqrt(m/kT)".
void name_abscissa(Rows rows, CurveTable& table) {
  const std::string head = abscissa_of(rows);
  const std::size_t blank = head.find(' ');
  table.columns.push_back(head.substr(0, blank));
  table.units.push_back(head.substr(blank + 2, head.size() - blank - 3));
}

}  // namespace

CurveTable curve_table(const CurveFile& file, const ed::Results& results) {
  if (file.rows == Rows::blocks) return table_of(block_columns(), results.blocks);
  if (file.rows == Rows::species) return results.groups.empty() ? CurveTable{} : species_table(results);
  if (file.rows == Rows::peaks) return table_of(peak_columns(), results.bragg);
  const std::vector<PartColumn> columns = columns_of(file, results);
  CurveTable table;
  name_abscissa(file.rows, table);
  for (const PartColumn& c : columns) {
    table.columns.insert(table.columns.end(), {c.name, c.name + "_error"});
    table.units.insert(table.units.end(), {c.column->unit, c.column->unit});
  }
  const auto add = [&](double x, const auto& value_of) {
    std::vector<double>& values = table.rows.emplace_back(std::vector{x});
    for (const PartColumn& c : columns) {
      const ed::Estimate estimate = value_of(c);
      values.insert(values.end(), {estimate.value, estimate.error});
    }
  };
  const bool from_zero = !file.columns.empty() && file.columns[0].at_zero != nullptr;
  if (from_zero) add(0, [](const PartColumn& c) { return c.at_zero(); });
  const std::vector<double> x = abscissae(file.rows, results);
  for (std::size_t k = 0; k < x.size(); ++k) add(x[k], [k](const PartColumn& c) { return c.at(k); });
  return table;
}

std::string curve_csv(const CurveFile& file, const ed::Results& results, Units units) {
  const CurveTable table = curve_table(file, results);
  std::string text;
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    text += fmt::format("{}{} [{}]", k == 0 ? "" : ",", table.columns[k], unit_text(table.units[k], units));
  }
  text += '\n';
  for (const std::vector<double>& row : table.rows) add_row(text, row);
  return text;
}

std::string events_header() {
  return "time,i,j\n";
}

std::string events_rows(std::span<const ed::Collision> collisions) {
  std::string text;
  for (const ed::Collision& c : collisions) {
    fmt::format_to(std::back_inserter(text), "{:.17g},{},{}\n", c.time, c.i, c.j);
  }
  return text;
}

}  // namespace hardbody
