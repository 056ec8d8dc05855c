#include "registry/curves.h"

#include "base/find.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <stdexcept>
#include <utility>

namespace hardbody {
namespace {

using ed::Correlations;
using ed::Estimate;
using ed::LagRow;

using ColumnValue = std::function<Estimate(const Correlations&, std::size_t, std::size_t)>;

ColumnValue of_lags(Estimate LagRow::*member) {
  return [member](const Correlations& c, std::size_t row, std::size_t /*k*/) { return c.lags[row].*member; };
}

ColumnValue of_axes(std::array<Estimate, 3> LagRow::*member) {
  return [member](const Correlations& c, std::size_t row, std::size_t axis) { return (c.lags[row].*member)[axis]; };
}

Estimate f_collective(const Correlations& c, std::size_t row, std::size_t k) {
  return c.lags[row].f_collective[k];
}

/// A column of what depends on orientations.
Column of_orientation(Column column) {
  column.of_orientation = true;
  return column;
}

Column of_pairs(const char* name, Estimate ed::PairRow::*member) {
  return {.name = name,
          .unit = "1",
          .value = [member](const Correlations& c, std::size_t row, std::size_t) { return c.pairs[row].*member; },
          .cross = [member](const ed::CrossStructure& c, std::size_t row) { return c.pairs[row].*member; }};
}

Estimate f_self(const Correlations& c, std::size_t row, std::size_t k) {
  return c.lags[row].f_self[k];
}

Estimate van_hove(const Correlations& c, std::size_t row, std::size_t k) {
  return row < c.displacements.size() ? c.displacements[row].G[k] : Estimate{};
}

Estimate structure_factor(const Correlations& c, std::size_t row, std::size_t /*k*/) {
  return c.structure[row].S;
}

std::vector<CurveFile> built_in_files() {
  return {
      {.name = "msd", .columns = {{"msd", "l^2", of_lags(&LagRow::msd)}}, .in_frames = true},
      {.name = "rotational_msd",
       .columns = {of_orientation({"rot_msd", "rad^2", of_lags(&LagRow::rot_msd)}),
                   of_orientation({"rot_msd_body", "rad^2", of_lags(&LagRow::rot_msd_body)}),
                   {"rot_msd_body", "rad^2", of_axes(&LagRow::rot_msd_axis), Split::axes}}},
      {.name = "msd_directions",
       .columns = {{"msd_parallel", "l^2", of_lags(&LagRow::msd_parallel)},
                   {"msd_perp", "l^2", of_lags(&LagRow::msd_perp)},
                   {"msd", "l^2", of_axes(&LagRow::msd_box), Split::edges}},
       .in_frames = true},
      {.name = "alpha2", .columns = {{"alpha2", "1", of_lags(&LagRow::alpha2)}}, .in_frames = true},
      {.name = "velocity",
       .columns = {{"vacf", "kT/m", of_lags(&LagRow::vacf), Split::none, &Correlations::v2},
                   of_orientation({"wacf", "kT/(m l^2)", of_lags(&LagRow::wacf), Split::none, &Correlations::w2})},
       .in_frames = true},
      {.name = "c1",
       .columns = {of_orientation({"c1", "1", of_lags(&LagRow::c1)}),
                   {"c1", "1", of_axes(&LagRow::c1_axis), Split::axes}},
       .in_frames = true},
      {.name = "c2",
       .columns = {of_orientation({"c2", "1", of_lags(&LagRow::c2)}),
                   {"c2", "1", of_axes(&LagRow::c2_axis), Split::axes}},
       .in_frames = true},
      {.name = "f_self", .columns = {{"f_self", "1", f_self, Split::wave_numbers}}, .in_frames = true},
      {.name = "f_collective", .columns = {{"f_collective", "1", f_collective, Split::collective}}, .in_frames = true},
      {.name = "overlap",
       .columns = {{"overlap", "1", of_lags(&LagRow::overlap)}, {"chi4", "1", of_lags(&LagRow::chi4)}},
       .in_frames = true},
      {.name = "g_r",
       .rows = Rows::pairs,
       .columns = {of_pairs("g", &ed::PairRow::g), of_orientation(of_pairs("g2", &ed::PairRow::g2))},
       .in_frames = true},
      {.name = "s_q",
       .rows = Rows::waves,
       .columns = {{.name = "S",
                    .unit = "1",
                    .value = structure_factor,
                    .cross = [](const ed::CrossStructure& c, std::size_t row) { return c.structure[row].S; }}},
       .in_frames = true},
      {.name = "van_hove",
       .rows = Rows::displacements,
       .columns = {{"G_s", "1/l^3", van_hove, Split::lags}},
       .in_frames = true},
      {.name = "bragg", .rows = Rows::peaks, .in_frames = true},
      {.name = "blocks", .rows = Rows::blocks},
      {.name = "species", .rows = Rows::species, .in_frames = true},
  };
}

std::vector<CurveFile>& registered_files() {
  static std::vector<CurveFile> all = built_in_files();
  return all;
}

constexpr const char* kTimeLabel = "t  [l √(m/kT)]";
constexpr const char* kRunTimeLabel = "t in production  [l √(m/kT)]";
constexpr const char* kFitted = " The dashed line is the fit to the first curve, which leaves the ballistic part out.";
constexpr const char* kStretched = "A exp[−(t/τ)ᵝ]";

// clang-format off
/// Plots against the lag.
std::vector<CurvePlot> lag_plots() {
  return {
      {.id = "msd", .title = "Mean square displacement",
       .about = "Of the centres.", .file = "msd", .y_label = "⟨Δr²⟩  [l²]",
       .log_y = true, .lines = {{"msd", "MSD", {Fit::Kind::slope, {"D_trans"}, "D", 6, "D_trans t", " The dashed line has the slope 6 D_trans."}}}},
      {.id = "msd_directions", .title = "Mean square displacement by direction",
       .about = "Along and across the director n, where there is one (both directions across it together), and along the "
                "edges of the box.", .file = "msd_directions", .y_label = "⟨Δr²⟩  [l²]", .log_y = true,
       .lines = {{"msd_parallel", "along n", {Fit::Kind::slope, {"D_parallel"}, "D", 2, "D_∥ t"}},
                 {"msd_perp", "across n", {Fit::Kind::slope, {"D_perp"}, "D", 4, "D_⊥ t"}},
                 {"msd_x", "x"}, {"msd_y", "y"}, {"msd_z", "z"}}},
      {.id = "rotational_msd", .title = "Rotational mean square displacement",
       .about = "Of the integral of the angular velocity, its components taken in the world or along the body’s axes.",
       .file = "rotational_msd", .y_label = "⟨ΔΦ²⟩  [rad²]", .log_y = true,
       .lines = {{"rot_msd", "world frame", {Fit::Kind::slope, {"D_rot"}, "D", 0, "D_rot t"}},
                 {"rot_msd_body", "body frame"}}},
      {.id = "c2", .title = "Orientation, second order",
       .about = "C₂: how far an axis still points where it pointed, up to its sign.", .file = "c2",
       .y_label = "C₂ = ⟨P₂(u(t)·u(0))⟩",
       .lines = {{"c2", "C₂", {Fit::Kind::stretched, {"tau_C2", "beta_C2"}, "C2", 0, kStretched, kFitted}}}},
      {.id = "c1", .title = "Orientation, first order", .about = "C₁: how far an axis still points where it pointed.",
       .file = "c1", .y_label = "C₁ = ⟨u(t)·u(0)⟩", .lines = {{"c1", "C₁"}}},
      {.id = "f_self", .title = "Self-intermediate scattering",
       .about = "F_self at the wave numbers of the legend.",
       .file = "f_self", .y_label = "Fₛ(q, t)",
       .lines = {{"f_self", "", {Fit::Kind::stretched, {"tau_F", "beta_F"}, "F", 0, kStretched, kFitted}}}},
      {.id = "f_collective", .title = "Collective intermediate scattering",
       .about = "F(q, t) / S(q) of all bodies, from wave vectors of the box about the wave numbers of the legend.",
       .file = "f_collective", .y_label = "F(q, t) / S(q)", .optional = true, .lines = {{"f_collective", ""}}},
      {.id = "overlap", .title = "Overlap", .about = "Q: share of the bodies that have moved by less than 0.3 diameters.",
       .file = "overlap", .y_label = "⟨Q(t)⟩", .lines = {{"overlap", "Q"}}},
      {.id = "chi4", .title = "Dynamic heterogeneity",
       .about = "Scatter of the overlap over time origins: large where bodies move together.", .file = "overlap",
       .y_label = "χ₄ = N (⟨Q²⟩ − ⟨Q⟩²)", .lines = {{"chi4", "χ₄"}}},
      {.id = "velocity", .title = "Velocity correlations",
       .about = "Over their values at t = 0. Below zero: bodies bounce back.", .file = "velocity",
       .y_label = "⟨v(t)·v(0)⟩ / ⟨v²⟩", .normalised = true,
       .lines = {{"vacf", "velocity"}, {"wacf", "angular velocity"}}},
      {.id = "alpha2", .title = "Non-Gaussian parameter",
       .about = "0 for displacements that are distributed as in free diffusion.", .file = "alpha2",
       .y_label = "α₂ = 3⟨Δr⁴⟩ / 5⟨Δr²⟩² − 1", .lines = {{"alpha2", "α₂"}}},
  };
}

/// Plots against distance, wave number and the time of the run.
std::vector<CurvePlot> other_plots() {
  return {
      {.id = "g_r", .title = "Pair correlations",
       .about = "g of the centres.", .file = "g_r", .x_label = "r  [l]", .y_label = "g(r)",
       .lines = {{"g", "g"}, {"g2", "g₂", {}, " g₂: mean P₂ of the angle between bodies r apart.", ", g₂(r)"}}},
      {.id = "s_q", .title = "Structure factor", .about = "Of the centres, at wave vectors of the box.",
       .file = "s_q", .x_label = "q  [1/l]", .y_label = "S(q)", .lines = {{"S", "S(q)"}}},
      {.id = "van_hove", .title = "Van Hove function",
       .about = "Self part: density of displacements of length r within the times of the legend.", .file = "van_hove",
       .x_label = "r  [l]", .y_label = "Gₛ(r, t)  [1/l³]", .log_y = true, .lines = {{"G_s", ""}}},
      {.id = "pressure", .title = "Compressibility factor in time",
       .about = "A drift would mean that the run is not equilibrated.", .file = "blocks", .x_label = kRunTimeLabel,
       .y_label = "Z = PV / NkT", .lines = {{"Z", "Z", {Fit::Kind::mean, {"Z"}, "", 0, "mean"}}}},
      {.id = "order", .title = "Nematic order in time",
       .about = "Largest eigenvalue of Q, averaged over stretches of the run.", .file = "blocks",
       .x_label = kRunTimeLabel, .y_label = "S", .lines = {{"S", "S", {Fit::Kind::mean, {"S"}, "", 0, "mean"}}}},
      {.id = "energy", .title = "Energy drift",
       .about = "Nothing but rounding: collisions are elastic and motion between them is exact.",
       .x_label = kRunTimeLabel, .y_label = "E(t) / E(0) − 1"},
  };
}
// clang-format on

std::vector<CurvePlot> all_plots() {
  std::vector<CurvePlot> all = lag_plots();
  for (CurvePlot& plot : all) {
    plot.x_label = kTimeLabel;
    plot.log_x = true;
  }
  for (CurvePlot& plot : other_plots()) all.push_back(std::move(plot));
  return all;
}

std::vector<CurvePlot>& registered_plots() {
  static std::vector<CurvePlot> all = all_plots();
  return all;
}

}  // namespace

const std::vector<CurveFile>& curve_files() {
  return registered_files();
}

bool is_written(const CurveFile& file, const ed::Results& results) {
  if (file.rows == Rows::species) return results.groups.size() > 1;
  return std::none_of(file.columns.begin(), file.columns.end(),
                      [](const Column& c) { return c.split == Split::collective; }) ||
         !results.decays_collective.empty();
}

const CurveFile* find_curves(std::string_view name) {
  return find_by(curve_files(), &CurveFile::name, name);
}

const std::vector<BlockColumn>& block_columns() {
  using Row = ed::BlockRow;
  static const std::vector<BlockColumn> all = {
      {"begin", "l sqrt(m/kT)", [](const Row& r) { return r.begin; }, true},
      {"end", "l sqrt(m/kT)", [](const Row& r) { return r.end; }, true},
      {"collision_rate", "sqrt(kT/m)/l", [](const Row& r) { return r.collision_rate; }},
      {"Z", "1", [](const Row& r) { return r.Z; }, true},
      {"kT_trans", "kT", [](const Row& r) { return r.translational_kT; }, true},
      {"kT_rot", "kT", [](const Row& r) { return r.rotational_kT; }, true},
      {"S", "1", [](const Row& r) { return r.S; }, true, true},
      {"director_x", "1", [](const Row& r) { return r.director.x(); }},
      {"director_y", "1", [](const Row& r) { return r.director.y(); }},
      {"director_z", "1", [](const Row& r) { return r.director.z(); }},
      {"Z_xx", "1", [](const Row& r) { return r.pressure(0, 0); }},
      {"Z_yy", "1", [](const Row& r) { return r.pressure(1, 1); }},
      {"Z_zz", "1", [](const Row& r) { return r.pressure(2, 2); }},
      {"Z_yz", "1", [](const Row& r) { return r.pressure(1, 2); }},
      {"Z_xz", "1", [](const Row& r) { return r.pressure(0, 2); }},
      {"Z_xy", "1", [](const Row& r) { return r.pressure(0, 1); }},
  };
  return all;
}

const std::vector<PeakColumn>& peak_columns() {
  using Row = ed::BraggRow;
  static const std::vector<PeakColumn> all = {
      {"q", "1/l", [](const Row& r) { return r.q; }},
      {"n_x", "1", [](const Row& r) { return static_cast<double>(r.n.x()); }},
      {"n_y", "1", [](const Row& r) { return static_cast<double>(r.n.y()); }},
      {"n_z", "1", [](const Row& r) { return static_cast<double>(r.n.z()); }},
      {"intensity", "1", [](const Row& r) { return r.intensity.value; }},
      {"intensity_error", "1", [](const Row& r) { return r.intensity.error; }},
      {"angle", "rad", [](const Row& r) { return r.angle; }},
  };
  return all;
}

std::string unit_text(const std::string& unit, Units units) {
  static const std::map<std::string, std::string, std::less<>> kDimensions = {
      {"1", "1"},
      {"rad", "rad"},
      {"rad^2", "rad^2"},
      {"l", "length"},
      {"l^2", "length^2"},
      {"1/l", "1/length"},
      {"1/l^3", "1/length^3"},
      {"l sqrt(m/kT)", "time"},
      {"sqrt(kT/m)/l", "1/time"},
      {"l sqrt(kT/m)", "length^2/time"},
      {"kT/m", "length^2/time^2"},
      {"kT/(m l^2)", "1/time^2"},
      {"kT", "energy"},
  };
  if (units == Units::of_runs) return unit;
  const auto found = kDimensions.find(unit);
  if (found == kDimensions.end()) throw std::logic_error("a unit without dimensions: " + unit);
  return found->second;
}

std::string abscissa_of(Rows rows, Units units) {
  const auto head = [units](const char* name, const char* unit) {
    return std::string(name) + " [" + unit_text(unit, units) + "]";
  };
  switch (rows) {
    case Rows::lags:
      return head("t", "l sqrt(m/kT)");
    case Rows::displacements:
    case Rows::pairs:
      return head("r", "l");
    case Rows::waves:
    case Rows::peaks:
      return head("q", "1/l");
    case Rows::species:
      return head("species", "1");
    case Rows::blocks:
      break;
  }
  return head("end", "l sqrt(m/kT)");
}

std::vector<std::string> required_columns(const CurveFile& file) {
  const std::string abscissa = abscissa_of(file.rows);
  std::vector<std::string> names = {abscissa.substr(0, abscissa.find(' '))};
  for (const Column& column : file.columns) {
    if (column.split == Split::none) names.push_back(column.name);
  }
  for (const CurvePlot& plot : plots()) {
    if (file.rows != Rows::blocks || plot.file != file.name) continue;
    for (const CurveLine& line : plot.lines) names.push_back(line.column);
  }
  return names;
}

bool is_of_orientation(const CurvePlot& plot, const CurveLine& line) {
  const auto is_the_line = [&](const auto& column) { return column.name == line.column && column.of_orientation; };
  const CurveFile* file = find_curves(plot.file);
  if (file == nullptr) return false;
  if (file->rows == Rows::blocks) return std::any_of(block_columns().begin(), block_columns().end(), is_the_line);
  return std::any_of(file->columns.begin(), file->columns.end(), is_the_line);
}

bool is_of_orientation(const CurvePlot& plot) {
  const auto of_orientation = [&](const CurveLine& line) { return is_of_orientation(plot, line); };
  return !plot.lines.empty() && std::all_of(plot.lines.begin(), plot.lines.end(), of_orientation);
}

const std::vector<CurvePlot>& plots() {
  return registered_plots();
}

RegisteredCurves::RegisteredCurves(CurveFile file, std::vector<CurvePlot> plots) : name_(file.name) {
  registered_files().push_back(std::move(file));
  for (CurvePlot& plot : plots) registered_plots().push_back(std::move(plot));
}

RegisteredCurves::~RegisteredCurves() {
  std::erase_if(registered_files(), [this](const CurveFile& f) { return f.name == name_; });
  std::erase_if(registered_plots(), [this](const CurvePlot& p) { return p.file == name_; });
}

}  // namespace hardbody
