#pragma once

/// Registry of observables: all that the program's outputs say about each. One entry puts an observable into
/// summary.json, analysis.json, sweep.csv, the tables on the terminal, reports, and the list in docs/output.md.

#include <ed/observables.h>

#include <array>
#include <cstddef>
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
  bool spheres = false;                ///< True if no body has an orientation.
  std::vector<double> wave_numbers{};  ///< Wave numbers of F_self.
  double averaged_axes = 0;            ///< Mean of rotation_axes over the bodies that D_rot averages over; 0: over all.
};

/// Returns the part of all bodies. `body_axes`: see Part.
Part whole_part(const ed::Results& results, const std::vector<ed::BodyGroup>& groups, bool body_axes,
                const std::vector<double>& wave_numbers);

/// Text that may depend on the bodies it is about.
using PartText = std::function<std::string(const Part&)>;

/// Member of the decays of F(q, t) / S(q), one value per wave number where they are measured.
struct CollectiveDecay {
  ed::Estimate ed::ScatteringDecay::*member;
};

/// Location of a value in the results: of all bodies and of each species, or of all bodies only (members of
/// ed::Results); arrays hold one value per body axis or edge of the box, members of ed::ScatteringDecay one per wave
/// number of F_self.
using ObservableValue = std::variant<ed::Estimate ed::GroupResults::*, ed::Estimate ed::Results::*,
                                     std::array<ed::Estimate, 3> ed::GroupResults::*, ed::Director ed::GroupResults::*,
                                     ed::TensorEstimate ed::Results::*, ed::Estimate (*)(const ed::GroupResults&),
                                     ed::Estimate ed::ScatteringDecay::*, CollectiveDecay>;

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
  std::string label{};          ///< name in tables on the terminal; of body axes without the axis; empty: in none
  PartText remark{};            ///< definition in the table of a run; none or an empty text: not in that table
  PartText convention{};        ///< definition among `units` in summary.json
  bool in_frames = false;       ///< true if stored frames tell it: part of analysis.json
  bool of_orientation = false;  ///< true if about orientation or rotation: not in tables and reports of spheres
  bool of_box = false;          ///< true if its three numbers are of the edges of the box, not of body axes
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

/// True for one number per body axis, or per edge of the box (Observable::of_box).
bool is_per_axis(const Observable& observable);

/// True for one number per wave number of F_self, or of F / S.
bool is_per_wave_number(const Observable& observable);

/// True for several numbers, a list in JSON files.
bool is_list(const Observable& observable);

/// Returns the numbers of a part: one, three of body axes, one per wave number, none of directors, tensors, and what
/// only all bodies have.
std::vector<ed::Estimate> numbers_of(const Observable& observable, const Part& part);

/// Returns whether a part has values of each axis: always of the edges of the box.
bool has_axes(const Observable& observable, const Part& part);

/// Returns the name of one number of an observable in tables: its label, with the axis if there are three.
std::string label_of(const Observable& observable, std::size_t number);

/// Returns whether bodies have a director: the state is nematic, or a crystal of aligned bodies.
bool has_director(const ed::GroupResults& results);

/// Returns whether two numbers differ by a tenth and by four of their standard errors.
bool are_apart(const ed::Estimate& a, const ed::Estimate& b);

/// Returns whether bodies move differently along the edges of the box: at the longest lag two of the mean square
/// displacements differ by a tenth and by four of their standard errors.
bool edges_differ(const ed::Correlations& results);

/// Returns a component of a director, 0 to 2, with its standard error: that of an angle, equal in all directions
/// across it.
ed::Estimate component_of(const ed::Director& director, int axis);

/// Returns whether outputs leave a number out altogether: it was not asked for, or the bodies have no such axes.
bool is_absent(const ed::Estimate& number);

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
