#include "run/files/observable_files.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
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

/// A pair of columns: a quantity and its error.
struct Column {
  std::string name;
  const char* unit;
  std::function<ed::Estimate(const ed::LagRow&)> value;
};

/// Whether the axes of these bodies are correlated each by itself.
bool has_axes(const ed::Correlations& correlations) {
  return !correlations.lags.empty() && std::isfinite(correlations.lags[0].c2_axis[0].value);
}

using ColumnsOf = std::function<std::vector<Column>(const std::string& suffix, bool axes)>;

std::vector<Column> msd_columns(const std::string& suffix, bool /*axes*/) {
  return {{"msd" + suffix, "l^2", [](const ed::LagRow& row) { return row.msd; }}};
}

std::vector<Column> alpha2_columns(const std::string& suffix, bool /*axes*/) {
  return {{"alpha2" + suffix, "1", [](const ed::LagRow& row) { return row.alpha2; }}};
}

std::vector<Column> velocity_columns(const std::string& suffix, bool /*axes*/) {
  return {{"vacf" + suffix, "kT/m", [](const ed::LagRow& row) { return row.vacf; }},
          {"wacf" + suffix, "kT/(m l^2)", [](const ed::LagRow& row) { return row.wacf; }}};
}

/// One for each wave number.
std::vector<Column> f_self_columns(const std::string& suffix, std::size_t number) {
  std::vector<Column> columns;
  for (std::size_t k = 0; k < number; ++k) {
    columns.push_back(
        {fmt::format("f_self{}_q{}", suffix, k + 1), "1", [k](const ed::LagRow& row) { return row.f_self[k]; }});
  }
  return columns;
}

constexpr const char* kAxisNames[] = {"_x", "_y", "_z"};

std::vector<Column> rotation_columns(const std::string& suffix, bool axes) {
  std::vector<Column> columns = {
      {"rot_msd" + suffix, "rad^2", [](const ed::LagRow& row) { return row.rot_msd; }},
      {"rot_msd_body" + suffix, "rad^2", [](const ed::LagRow& row) { return row.rot_msd_body; }}};
  for (std::size_t k = 0; k < 3 && axes; ++k) {
    columns.push_back(
        {"rot_msd_body" + suffix + kAxisNames[k], "rad^2", [k](const ed::LagRow& row) { return row.rot_msd_axis[k]; }});
  }
  return columns;
}

std::vector<Column> c1_columns(const std::string& suffix, bool axes) {
  std::vector<Column> columns = {{"c1" + suffix, "1", [](const ed::LagRow& row) { return row.c1; }}};
  for (std::size_t k = 0; k < 3 && axes; ++k) {
    columns.push_back({"c1" + suffix + kAxisNames[k], "1", [k](const ed::LagRow& row) { return row.c1_axis[k]; }});
  }
  return columns;
}

std::vector<Column> c2_columns(const std::string& suffix, bool axes) {
  std::vector<Column> columns = {{"c2" + suffix, "1", [](const ed::LagRow& row) { return row.c2; }}};
  for (std::size_t k = 0; k < 3 && axes; ++k) {
    columns.push_back({"c2" + suffix + kAxisNames[k], "1", [k](const ed::LagRow& row) { return row.c2_axis[k]; }});
  }
  return columns;
}

/// All bodies, then, where there are several species, each.
std::vector<const ed::Correlations*> parts_of(const ed::Results& results) {
  std::vector<const ed::Correlations*> parts = {&results};
  if (results.groups.size() > 1) {
    for (const ed::GroupResults& group : results.groups) parts.push_back(&group);
  }
  return parts;
}

/// Of the columns of a part.
std::string part_suffix(std::size_t part) {
  return part == 0 ? "" : fmt::format("_{}", part);
}

/// Lag 0 of the velocities' correlations, of which displacements and orientations need none.
ed::LagRow row_at_zero(const ed::Correlations& correlations) {
  ed::LagRow row{};
  row.vacf = correlations.v2;
  row.wacf = correlations.w2;
  return row;
}

enum class FirstLag { shortest, zero };

/// Against the lag.
std::string lag_csv(const ed::Results& results, const ColumnsOf& columns, FirstLag first = FirstLag::shortest) {
  const std::vector<const ed::Correlations*> parts = parts_of(results);
  std::string text = "t [l sqrt(m/kT)]";
  std::vector<std::vector<Column>> of_part;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    of_part.push_back(columns(part_suffix(p), has_axes(*parts[p])));
    for (const Column& c : of_part.back()) text += fmt::format(",{0} [{1}],{0}_error [{1}]", c.name, c.unit);
  }
  text += '\n';
  const auto add = [&](double lag, const auto& row_of) {
    std::vector<double> values = {lag};
    for (std::size_t p = 0; p < parts.size(); ++p) {
      for (const Column& c : of_part[p]) {
        const ed::Estimate estimate = c.value(row_of(*parts[p]));
        values.push_back(estimate.value);
        values.push_back(estimate.error);
      }
    }
    add_row(text, values);
  };
  if (first == FirstLag::zero) add(0, row_at_zero);
  for (std::size_t k = 0; k < results.lags.size(); ++k) {
    add(results.lags[k].lag, [k](const ed::Correlations& part) -> const ed::LagRow& { return part.lags[k]; });
  }
  return text;
}

}  // namespace

std::string msd_csv(const ed::Results& results) {
  return lag_csv(results, msd_columns);
}

std::string rotational_msd_csv(const ed::Results& results) {
  return lag_csv(results, rotation_columns);
}

std::string alpha2_csv(const ed::Results& results) {
  return lag_csv(results, alpha2_columns);
}

std::string f_self_csv(const ed::Results& results) {
  const std::size_t number = results.lags.empty() ? 0 : results.lags[0].f_self.size();
  return lag_csv(results,
                 [number](const std::string& suffix, bool /*axes*/) { return f_self_columns(suffix, number); });
}

std::string velocity_csv(const ed::Results& results) {
  return lag_csv(results, velocity_columns, FirstLag::zero);
}

std::string c1_csv(const ed::Results& results) {
  return lag_csv(results, c1_columns);
}

std::string c2_csv(const ed::Results& results) {
  return lag_csv(results, c2_columns);
}

std::string pairs_csv(const ed::Results& results) {
  const std::vector<const ed::Correlations*> parts = parts_of(results);
  std::string text = "r [l]";
  for (std::size_t p = 0; p < parts.size(); ++p) {
    fmt::format_to(std::back_inserter(text), ",g{0} [1],g{0}_error [1],g2{0} [1],g2{0}_error [1]", part_suffix(p));
  }
  text += '\n';
  for (std::size_t k = 0; k < results.pairs.size(); ++k) {
    std::vector<double> values = {results.pairs[k].r};
    for (const ed::Correlations* part : parts) {
      const ed::PairRow& row = part->pairs[k];
      values.insert(values.end(), {row.g.value, row.g.error, row.g2.value, row.g2.error});
    }
    add_row(text, values);
  }
  return text;
}

std::string structure_csv(const ed::Results& results) {
  const std::vector<const ed::Correlations*> parts = parts_of(results);
  std::string text = "q [1/l]";
  for (std::size_t p = 0; p < parts.size(); ++p) {
    fmt::format_to(std::back_inserter(text), ",S{0} [1],S{0}_error [1]", part_suffix(p));
  }
  text += '\n';
  for (std::size_t k = 0; k < results.structure.size(); ++k) {
    std::vector<double> values = {results.structure[k].q};
    for (const ed::Correlations* part : parts) {
      values.insert(values.end(), {part->structure[k].S.value, part->structure[k].S.error});
    }
    add_row(text, values);
  }
  return text;
}

std::string blocks_csv(const ed::Results& results) {
  std::string text =
      "begin [l sqrt(m/kT)],end [l sqrt(m/kT)],collision_rate [sqrt(kT/m)/l],Z [1],kT_trans [kT],kT_rot "
      "[kT],S [1],director_x [1],director_y [1],director_z [1],Z_xx [1],Z_yy [1],Z_zz [1],Z_yz [1],Z_xz [1],Z_xy [1]\n";
  for (const ed::BlockRow& row : results.blocks) {
    const Eigen::Vector3d& n = row.director;
    const Eigen::Matrix3d& P = row.pressure;
    add_row(text, {row.begin, row.end, row.collision_rate, row.Z, row.translational_kT, row.rotational_kT, row.S, n.x(),
                   n.y(), n.z(), P(0, 0), P(1, 1), P(2, 2), P(1, 2), P(0, 2), P(0, 1)});
  }
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
