#pragma once

/// Registry of curves: the CSV files in observables/ with their columns, and the plots that reports draw of them.

#include <ed/observables.h>

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Rows of a file: lags, distances of pairs, wave numbers of S(q), blocks of the run.
enum class Rows { lags, pairs, waves, blocks };

/// Splitting of a quantity into several columns: body axes (x, y, z) or wave numbers of F_self (q1, q2, ..).
enum class Split { none, axes, wave_numbers };

/// Units that a header names: those of runs (l, kT, m), or dimensions for a file whose units are unknown.
enum class Units { of_runs, unknown };

/// Returns a unit as headers have it: "l^2", or "length^2".
std::string unit_text(const std::string& unit, Units units);

/// A quantity, one column of values and one of errors for all bodies and for each species.
struct Column {
  std::string name{};
  std::string unit{};
  /// Returns the value in a row; the last argument counts axes or wave numbers.
  std::function<ed::Estimate(const ed::Correlations&, std::size_t row, std::size_t k)> value{};
  Split split = Split::none;
  ed::Estimate ed::Correlations::*at_zero = nullptr;  ///< value at lag 0, if the file begins there
};

/// A column of blocks.csv, without errors.
struct BlockColumn {
  std::string name{};
  std::string unit{};
  double (*value)(const ed::BlockRow&) = nullptr;
  bool in_reports = false;  ///< true if reports read it
};

/// A file in observables/.
struct CurveFile {
  std::string name{};  ///< name without directory and ending: "msd"
  Rows rows = Rows::lags;
  std::vector<Column> columns{};  ///< columns after the first one; those of Rows::blocks are block_columns()
  bool in_frames = false;         ///< true if stored frames tell it: `hardbody analyze` writes it, too

  /// Returns the place in a run directory: "observables/msd.csv".
  std::string path() const { return "observables/" + name + ".csv"; }
};

/// Returns all files, in the order in which they are written.
const std::vector<CurveFile>& curve_files();
const std::vector<BlockColumn>& block_columns();

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
};

/// Curves of one column: all bodies, each species, each body axis or wave number.
struct CurveLine {
  std::string column{};
  std::string label{};
  Fit fit{};
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
  std::vector<CurveLine> lines{};
};

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
