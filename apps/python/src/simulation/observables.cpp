#include "simulation/observables.h"

#include "base/arguments.h"
#include "base/arrays.h"
#include "base/unlocked.h"
#include "base/values.h"
#include "simulation/bind.h"

#include <config/config.h>
#include <registry/curves.h>
#include <registry/observables.h>
#include <run/files/observable_files.h>
#include <run/missing.h>

#include <ed/analysis.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace hardbody::python {
namespace {

const MissingWords& words() {
  static const MissingWords made = [] {
    MissingWords list;
    list.longer_lags = "longer lags help";
    return list;
  }();
  return made;
}

/// Values that hardbody._observables makes objects of.
class Values {
 public:
  Values() : module_(nb::module_::import_("hardbody._observables")) {}

  nb::object estimate(const ed::Estimate& e) const {
    nb::object missing = nb::none();
    if (!std::isfinite(e.value)) missing = nb::cast(missing_text(e.missing, words()));
    return module_.attr("Estimate")(e.value, e.error, missing);
  }

  nb::object vector(const ed::Director& director, const ed::Estimate& S) const {
    return module_.attr("VectorEstimate")(array_of(director.axis), director.error,
                                          missing(director.axis.allFinite(), S));
  }

  nb::object tensor(const ed::TensorEstimate& tensor, const ed::Estimate& Z) const {
    return module_.attr("TensorEstimate")(array_of(tensor.value), array_of(tensor.error),
                                          missing(tensor.value.allFinite(), Z));
  }

  nb::object results(const nb::dict& numbers, const nb::dict& curves, const nb::list& groups) const {
    return module_.attr("Results")(numbers, curves, groups);
  }

 private:
  /// The reason, that of another value, for which one is missing.
  static nb::object missing(bool is_there, const ed::Estimate& other) {
    if (is_there) return nb::none();
    return nb::cast(missing_text(other.missing, words()));
  }

  nb::object module_;
};

/// Returns the value of an observable; null if the part has none of that kind.
nb::object value_of(const Observable& observable, const Part& part, const Values& values) {
  if (const auto* member = std::get_if<ed::Director ed::GroupResults::*>(&observable.value)) {
    return values.vector(part.results.**member, part.results.S);
  }
  if (const auto* member = std::get_if<ed::TensorEstimate ed::Results::*>(&observable.value)) {
    return part.whole == nullptr ? nb::object() : values.tensor(part.whole->**member, part.whole->Z);
  }
  if (is_per_axis(observable) && !observable.of_box && !part.body_axes) return {};
  nb::list list;
  for (const ed::Estimate& e : numbers_of(observable, part)) {
    if (is_number(observable) && is_absent(e)) return {};
    list.append(values.estimate(e));
  }
  if (nb::len(list) == 0) return {};
  return is_list(observable) ? nb::object(nb::tuple(list)) : nb::object(list[0]);
}

nb::dict numbers_of(const Part& part, const Values& values) {
  nb::dict made;
  for (const Observable* observable : observables_by(&Places::summary)) {
    const nb::object value = value_of(*observable, part, values);
    if (value.is_valid()) made[observable->key.c_str()] = value;
  }
  return made;
}

/// Returns a table as a structured array, and the units of its columns: dimensions, as the caller's units are not
/// known.
nb::tuple structured(const CurveTable& table) {
  const std::size_t columns = table.columns.size();
  const NewArray<double> numbers = new_array<double>({table.rows.size(), columns});
  double* out = numbers.data;
  for (const std::vector<double>& row : table.rows) out = std::copy(row.begin(), row.end(), out);
  nb::list fields;
  for (const std::string& name : table.columns) fields.append(nb::make_tuple(name, "f8"));
  const nb::object type = nb::module_::import_("numpy").attr("dtype")(fields);
  nb::dict units;
  for (std::size_t k = 0; k < columns; ++k) {
    units[table.columns[k].c_str()] = unit_text(table.units[k], Units::unknown);
  }
  return nb::make_tuple(numbers.array.attr("view")(type).attr("reshape")(-1), units);
}

nb::dict curves_of(const ed::Results& results) {
  nb::dict made;
  for (const CurveFile& file : curve_files()) {
    if (is_written(file, results)) made[file.name.c_str()] = structured(curve_table(file, results));
  }
  return made;
}

nb::object results_of(const PythonObservables& self) {
  const auto& simulation = nb::cast<const PythonSimulation&>(self.simulation);
  const ed::ObservablesOptions& options = self.measurement->options;
  const ed::Simulation& running = simulation.whole();
  const ed::Results results = self.measurement->observables.results(running);
  const Values values;
  const bool single = options.groups.size() == 1;
  const bool body_axes = single && options.groups[0].rotation_axes == 3;
  const Part all = whole_part(results, options.groups, body_axes, options.wave_numbers);
  nb::list groups;
  for (std::size_t k = 0; !single && k < results.groups.size(); ++k) {
    const ed::BodyGroup& g = options.groups[k];
    const Part part{.results = results.groups[k],
                    .number = g.number,
                    .rotation_axes = static_cast<double>(g.rotation_axes),
                    .body_axes = g.rotation_axes == 3,
                    .spheres = !g.oriented,
                    .wave_numbers = options.wave_numbers};
    groups.append(values.results(numbers_of(part, values), nb::dict(), nb::list()));
  }
  return values.results(numbers_of(all, values), curves_of(results), groups);
}

/// Returns what the list `order` asks for, each word at most once.
ed::BondOptions bond_options(nb::handle order, nb::handle neighbours) {
  ed::BondOptions bonds{};
  bonds.neighbours =
      static_cast<int>(integer(neighbours, "order_neighbours", ed::kFewestNeighbours, ed::kMostNeighbours));
  const std::string accepted = "a list of \"steinhardt\" and \"hexatic\", each at most once";
  if (!nb::isinstance<nb::list>(order) && !nb::isinstance<nb::tuple>(order)) refuse_type("order", order, accepted);
  for (const nb::handle item : order) {
    const BondOrder one = choice(item, "order", std::array{BondOrder::steinhardt, BondOrder::hexatic});
    bool& asked = one == BondOrder::steinhardt ? bonds.steinhardt : bonds.hexatic;
    if (asked) refuse_value("order", std::string(nb::repr(order).c_str()), accepted);
    asked = true;
  }
  return bonds;
}

}  // namespace

ed::ObservablesOptions measuring_options(const BodySystem& bodies, nb::handle duration, nb::handle longest_lag,
                                         nb::handle wave_numbers, nb::handle collective, nb::handle order,
                                         nb::handle order_neighbours) {
  ed::ObservablesOptions options{};
  options.collective = truth(collective, "collective");
  options.bonds = bond_options(order, order_neighbours);
  options.number = bodies.system.size();
  options.duration = positive(duration, "duration");
  options.time_unit = ed::time_unit(bodies.system);
  options.groups = body_groups(bodies);
  if (!longest_lag.is_none()) options.longest_lag = positive(longest_lag, "longest_lag");
  if (options.longest_lag > options.duration) {
    refuse_value("longest_lag", shown(options.longest_lag), "at most the duration, " + shown(options.duration));
  }
  if (wave_numbers.is_none()) {
    options.wave_numbers = ed::wave_numbers_about(ed::structure_peak(bodies.system));
    return options;
  }
  const RealArray array(wave_numbers, "wave_numbers", "real numbers of shape (n,)");
  if (array.shape().size() != 1) refuse_shape("wave_numbers", array.shape(), "shape (n,)");
  options.wave_numbers.assign(array.data(), array.data() + array.shape()[0]);
  for (const double q : options.wave_numbers) {
    if (!(q > 0) || !std::isfinite(q)) refuse_value("wave_numbers", shown(q), "finite numbers above 0");
  }
  if (options.wave_numbers.size() > ed::kMostWaveNumbers) {
    refuse_value("number of wave_numbers", std::to_string(options.wave_numbers.size()),
                 "at most " + std::to_string(ed::kMostWaveNumbers));
  }
  return options;
}

void bind_observables(nb::module_& module) {
  nb::class_<PythonObservables> type(
      module, "Observables", nb::is_weak_referenceable(),
      "Observables of a simulation, measured while it runs, in memory that does not grow with\n"
      "the run's length. Made by Simulation.measure.");
  type.def_prop_ro(
          "duration", [](const PythonObservables& o) { return o.measurement->options.duration; },
          "Planned duration; later motion is not measured.")
      .def_prop_ro(
          "wave_numbers", [](const PythonObservables& o) { return array_of(o.measurement->options.wave_numbers); },
          nb::for_getter(nb::sig("def wave_numbers(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Wave numbers of F_self.")
      .def_prop_ro(
          "next_time", [](const PythonObservables& o) { return o.measurement->observables.next_time(); },
          "Time of the next measurement; infinite when the duration is covered.")
      .def("results", &results_of, nb::sig("def results(self) -> hardbody.Results"),
           "Returns all results so far: values with errors, and curves as structured arrays.")
      .def("__repr__", [](const PythonObservables& o) {
        return "Observables(duration=" + shown(o.measurement->options.duration) +
               ", next_time=" + shown(o.measurement->observables.next_time()) + ')';
      });
  refuse_pickling(type, "Observables", "results(), or the bytes of save() of their simulation");
}

}  // namespace hardbody::python
