#pragma once

/// Registry of curves: the CSV files in observables/ with their columns, and the plots that reports draw of them.

#include <ed/observables.h>

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Rows of a file: lags, distances of pairs, wave numbers of S(q), displacements, Bragg peaks, blocks of the run,
/// species.
enum class Rows { lags, pairs, waves, displacements, peaks, blocks, species };

/// Splitting of a quantity into several columns: body axes (x, y, z), edges of the box (x, y, z), wave numbers of
/// F_self or of F / S (q1, q2, ..), or lags of the van Hove function (t1, t2, ..).
enum class Split { none, axes, edges, wave_numbers, collective, lags };

/// Units that a header names: those of runs (l, kT, m), or dimensions for a file whose units are unknown.
enum class Units { of_runs, unknown };

/// Returns a unit as headers have it: "l^2", or "length^2".
std::string unit_text(const std::string& unit, Units units);

/// A quantity, one column of values and one of errors for all bodies and for each species.
struct Column {
  std::string name{};
  std::string unit{};
  /// Returns the value in a row; the last argument counts axes, wave numbers or lags.
  std::function<ed::Estimate(const ed::Correlations&, std::size_t row, std::size_t k)> value{};
  Split split = Split::none;
  ed::Estimate ed::Correlations::*at_zero = nullptr;  ///< value at lag 0, if the file begins there
  bool of_orientation = false;                        ///< true to leave it out for species of spheres
  /// Returns the value of two species in a row: one more column for each two.
  std::function<ed::Estimate(const ed::CrossStructure&, std::size_t row)> cross{};
};

/// A column of blocks.csv, without errors.
struct BlockColumn {
  std::string name{};
  std::string unit{};
  double (*value)(const ed::BlockRow&) = nullptr;
  bool in_reports = false;      ///< true if reports read it
  bool of_orientation = false;  ///< true to leave it out of reports of spheres
};

/// A column of bragg.csv.
struct PeakColumn {
  std::string name{};
  std::string unit{};
  double (*value)(const ed::BraggRow&) = nullptr;
};

/// A file in observables/.
struct CurveFile {
  std::string name{};  ///< name without directory and ending: "msd"
  Rows rows = Rows::lags;
  /// Columns after the first one; of Rows::blocks and Rows::peaks see block_columns() and peak_columns(), those of
  /// Rows::species are the numbers of summary.json.
  std::vector<Column> columns{};
  bool in_frames = false;  ///< true if stored frames tell it: `hardbody analyze` writes it, too

  /// Returns the place in a run directory: "observables/msd.csv".
  std::string path() const { return "observables/" + name + ".csv"; }
};

/// Returns whether there is anything to write: collective functions are measured only if asked for, and species are
/// compared if there are several.
bool is_written(const CurveFile& file, const ed::Results& results);

/// Returns all files, in the order in which they are written.
const std::vector<CurveFile>& curve_files();
/// Return all columns of files of Rows::blocks and Rows::peaks.
/// @{
const std::vector<BlockColumn>& block_columns();
const std::vector<PeakColumn>& peak_columns();
/// @}

/// Returns the file of that name; null if there is none.
const CurveFile* find_curves(std::string_view name);

/// Returns the header of the first column: "t [l sqrt(m/kT)]".
std::string abscissa_of(Rows rows, Units units = Units::of_runs);

/// Returns the columns without which a file of a run is refused; the first is the abscissa of plots.
std::vector<std::string> required_columns(const CurveFile& file);

/// Dashed line beside a curve, drawn from values of the summary.
struct Fit {
  enum class Kind { none, slope, stretched, mean };
  Kind kind = Kind::none;
  std::vector<std::string> keys{};  ///< slope: D; stretched: tau and beta; mean: the value
  std::string window{};             ///< key in fit_windows: the lags that were fitted
  double factor = 0;                ///< slope / D; 0: twice the number of rotation components
  std::string label{};              ///< label in the plot; of slopes without their factor
  std::string about{};              ///< text that follows the plot's, where the line is drawn
};

/// Curves of one column: all bodies, each species, each body axis or wave number.
struct CurveLine {
  std::string column{};
  std::string label{};
  Fit fit{};
  std::string about{};    ///< text that follows the plot's, where the line is drawn
  std::string y_label{};  ///< text that follows the label of the plot's axis, where the line is drawn
};

/// A plot of curves.
struct CurvePlot {
  std::string id{};
  std::string title{};
  std::string about{};
  std::string file{};  ///< name of the CurveFile; empty: the report computes it by itself
  std::string x_label{};
  std::string y_label{};
  bool log_x = false;
  bool log_y = false;
  bool normalised = false;  ///< true if values are divided by the first one, of all bodies only
  bool optional = false;    ///< true to leave it out of reports of which no run has the file
  std::vector<CurveLine> lines{};
};

/// True for a line whose column is about orientation: left out for spheres.
bool is_of_orientation(const CurvePlot& plot, const CurveLine& line);

/// True for a plot whose lines are all about orientation: left out for spheres.
bool is_of_orientation(const CurvePlot& plot);

/// Returns the plots of a report, in their order.
const std::vector<CurvePlot>& plots();

/// Adds a further file, and plots of it, as long as the object lives.
class RegisteredCurves {
 public:
  explicit RegisteredCurves(CurveFile file, std::vector<CurvePlot> plots = {});
  ~RegisteredCurves();
  RegisteredCurves(const RegisteredCurves&) = delete;
  RegisteredCurves& operator=(const RegisteredCurves&) = delete;

 private:
  std::string name_;
};

}  // namespace hardbody
