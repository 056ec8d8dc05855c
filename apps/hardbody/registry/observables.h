#pragma once

/// Registry of observables: all that the program's outputs say about each. One entry puts an observable into
/// summary.json, analysis.json, sweep.csv, the tables on the terminal, reports, and the list in docs/output.md.

#include <ed/observables.h>

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hardbody {

inline constexpr std::array kBodyAxes = {"x", "y", "z"};

/// Bodies that an output is about, all or one species, and what was measured of them.
struct Part {
  const ed::GroupResults& results;
  const ed::Results* whole = nullptr;  ///< Results of all bodies; null for one species.
  int number = 0;                      ///< Number of bodies.
  double rotation_axes = 2;            ///< Mean number of components of a body's rotation.
  bool body_axes = false;              ///< True if each body axis has values of its own.
  std::vector<double> wave_numbers{};  ///< Wave numbers of F_self.
};

/// Text that may depend on the bodies it is about.
using PartText = std::function<std::string(const Part&)>;

/// Location of a value in the results: of all bodies and of each species, or of all bodies only (members of
/// ed::Results); arrays hold one value per body axis.
using ObservableValue = std::variant<ed::Estimate ed::GroupResults::*, ed::Estimate ed::Results::*,
                                     std::array<ed::Estimate, 3> ed::GroupResults::*, ed::Director ed::GroupResults::*,
                                     ed::TensorEstimate ed::Results::*, ed::Estimate (*)(const ed::GroupResults&)>;

/// Positions of an observable in outputs, whose orders differ. Entries are sorted by these numbers.
struct Places {
  int summary = 1000;  ///< place in the JSON files and sweep.csv
  int reading = 1000;  ///< place in the table of a run, and in reports
  int units = 0;       ///< place among `units` in summary.json; 0: left out
  int card = 0;        ///< place on the first card of a report; 0: under "more"
  int map = 0;         ///< place among the maps of a sweep's static report; 0: left out
  int opened = 0;      ///< place among the maps that a sweep's report opens first, as far as there are values
};

/// An observable: a number with its standard error, three of them (one per body axis), a director or a tensor.
struct Observable {
  std::string key{};         ///< name in JSON files, sweep.csv and documentation
  std::string symbol{};      ///< symbol in reports; the part after an underscore is an index
  std::string name{};        ///< name in words, in reports; of body axes without the axis
  std::string unit{};        ///< unit as in CSV files: "l sqrt(kT/m)", "1"
  std::string definition{};  ///< definition in reports and documentation
  ObservableValue value{};
  std::string label{};     ///< name in tables on the terminal; of body axes without the axis; empty: in none
  PartText remark{};       ///< definition in the table of a run; none or an empty text: not in that table
  PartText convention{};   ///< definition among `units` in summary.json
  bool in_frames = false;  ///< true if stored frames tell it: part of analysis.json
  Places places{};
};

/// Returns all observables, in the order of documentation and of `hardbody analyze`.
const std::vector<Observable>& observables();

/// Returns the observables whose place is not 0, sorted by it.
std::vector<const Observable*> observables_by(int Places::*place);

/// Returns the keys of observables_by(place).
std::vector<std::string> keys_by(int Places::*place);

/// Returns the observable with that key; null if there is none.
const Observable* find_observable(std::string_view key);

/// True for a single number with its error.
bool is_number(const Observable& observable);

/// True for one number per body axis.
bool is_per_axis(const Observable& observable);

/// Returns the numbers of a part: one, three of body axes, none of directors, tensors, and what only all bodies have.
std::vector<ed::Estimate> numbers_of(const Observable& observable, const Part& part);

/// Returns the unit as reports write it: "l √(kT/m)"; empty for pure numbers.
std::string report_unit(const Observable& observable);

/// Adds a further observable as long as the object lives.
class RegisteredObservable {
 public:
  explicit RegisteredObservable(Observable observable);
  ~RegisteredObservable();
  RegisteredObservable(const RegisteredObservable&) = delete;
  RegisteredObservable& operator=(const RegisteredObservable&) = delete;

 private:
  std::string key_;
};

}  // namespace hardbody
