#include "base/arguments.h"
#include "simulation/bind.h"
#include "simulation/observables.h"
#include "simulation/simulation.h"

#include <ed/simulation.h>

#include <nanobind/nanobind.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

namespace hardbody::python {
namespace {

using Type = nb::class_<PythonSimulation>;

/// Returns a duration: a finite number, not below 0.
double duration(nb::handle value, const char* name) {
  const double read = number(value, name);
  if (!(read >= 0) || !std::isfinite(read)) refuse_value(name, shown(read), "a finite number, at least 0");
  return read;
}

void check_function(nb::handle value, const char* name, const char* accepted) {
  if (!value.is_none() && PyCallable_Check(value.ptr()) == 0) refuse_type(name, value, accepted);
}

/// True and False as progress: a line on the terminal, or none.
nb::object progress_function(nb::handle progress) {
  if (progress.is(nb::handle(Py_False))) return nb::none();
  if (progress.is(nb::handle(Py_True))) return nb::module_::import_("hardbody._progress").attr("ProgressLine")();
  check_function(progress, "progress", "a function of the fraction done, True, False, None");
  return nb::borrow(progress);
}

void run(nb::handle self, nb::handle time, nb::handle collisions, nb::handle until, nb::handle every,
         nb::handle callback, nb::handle progress) {
  auto& simulation = instance<PythonSimulation>(self, "self");
  RunPlan plan;
  if (time.is_none() + collisions.is_none() + until.is_none() != 2) {
    throw nb::type_error(
        "run takes one of time, collisions and until; accepted: run(time=...), run(collisions=...), "
        "run(until=...)");
  }
  const double now = simulation.idle().time();
  if (!time.is_none()) plan.end = now + duration(time, "time");
  if (!until.is_none()) plan.end = duration(until, "until");
  if (plan.end < now) refuse_value("until", shown(plan.end), "at least " + shown(now) + ", the time reached");
  if (!collisions.is_none()) {
    plan.collisions =
        static_cast<std::uint64_t>(integer(collisions, "collisions", 0, std::numeric_limits<std::int64_t>::max()));
  }
  check_function(callback, "callback", "a function of the simulation, or None");
  if (callback.is_none() != every.is_none()) {
    throw nb::type_error("every and callback belong together; accepted: both, or neither");
  }
  if (!every.is_none()) {
    plan.every = positive(every, "every");
    const double latest = std::isfinite(plan.end) ? plan.end : now;
    if (!(latest + plan.every > latest))
      refuse_value("every", shown(plan.every),
                   "at least " + shown(2 * (std::nextafter(latest, HUGE_VAL) - latest)) + ", for doubles near time " +
                       shown(latest));
  }
  plan.callback = callback;
  const nb::object shown_to = progress_function(progress);
  plan.progress = shown_to;
  simulation.run(self, plan);
}

void bind_run(Type& type) {
  type.def("run", &run, nb::arg("time") = nb::none(), nb::arg("collisions") = nb::none(), nb::kw_only(),
           nb::arg("until") = nb::none(), nb::arg("every") = nb::none(), nb::arg("callback") = nb::none(),
           nb::arg("progress") = nb::none(),
           nb::sig("def run(self, time: float | None = None, collisions: int | None = None, *, "
                   "until: float | None = None, every: float | None = None, "
                   "callback: collections.abc.Callable[[Simulation], object] | None = None, "
                   "progress: collections.abc.Callable[[float], object] | bool | None = None) -> None"),
           "Runs for a time, for a number of collisions, or until a time since the start.\n"
           "\n"
           "callback(simulation) is called whenever the time `every` has passed since the begin of this run, and ends "
           "the\n"
           "run by returning False. progress: a function that is given the fraction done about ten times a second; "
           "True:\n"
           "a line on stderr.\n"
           "\n"
           "The GIL is released, but for calls into Python. Ctrl-C raises KeyboardInterrupt between two events, within "
           "a\n"
           "tenth of a second: the simulation is whole, and goes on with the same bits. NumericalError is raised at "
           "the end,\n"
           "or before the next callback, if bodies overlapped, no method could decide whether they do, or bodies in "
           "contact\n"
           "did not approach; and at once if the run stalls. An exception in a shape of your own is raised when the "
           "event\n"
           "loop has returned; the simulation then cannot be used.");
}

void bind_changes(Type& type) {
  type.def(
          "shrink_box",
          [](PythonSimulation& s, nb::handle target_box, nb::handle least_gain) {
            return s.shrink_box(target_box, duration(least_gain, "least_gain"));
          },
          nb::arg("target_box").none(), nb::arg("least_gain").none() = 0.0,
          nb::sig("def shrink_box(self, target_box: float, least_gain: float = 0.0) -> float"),
          "Scales the box and all positions down to target_box, at most the box, if that causes no overlap, else so "
          "that a tenth of the\n"
          "closest pair's gap is left, and not at all by less than a fraction least_gain. Returns the new box. "
          "Velocities\n"
          "are unchanged. Needs neighbours='dilated'.")
      .def("tune_envelopes", &PythonSimulation::tune_envelopes, nb::sig("def tune_envelopes(self) -> None"),
           "Chooses the thickness of the neighbour lists' envelopes by the work that the counters show. Runs trials, "
           "mostly\n"
           "three to six, of 3 collisions a body each, but no fewer than 6144; the time advances. Raises RuntimeError "
           "with neighbours='cells', which have no envelopes.")
      .def(
          "record_collisions",
          [](PythonSimulation& s, nb::handle number) {
            s.idle().record_collisions(
                static_cast<std::size_t>(integer(number, "number", 0, std::numeric_limits<std::int64_t>::max())));
          },
          nb::arg("number").none(), nb::sig("def record_collisions(self, number: int) -> None"),
          "Starts recording: `recorded` will hold the next `number` collisions.");
}

void bind_measure(Type& type) {
  type.def(
      "measure",
      [](nb::handle self, nb::handle duration, nb::handle longest_lag, nb::handle wave_numbers, nb::handle collective,
         nb::handle order, nb::handle order_neighbours) {
        auto& s = instance<PythonSimulation>(self, "self");
        return PythonObservables{
            nb::borrow(self), s.measure(measuring_options(s.bodies(), duration, longest_lag, wave_numbers, collective,
                                                          order, order_neighbours))};
      },
      nb::arg("duration").none(), nb::arg("longest_lag") = nb::none(), nb::arg("wave_numbers") = nb::none(),
      nb::arg("collective") = false, nb::arg("order").none() = nb::tuple(), nb::arg("order_neighbours").none() = 12,
      nb::sig("def measure(self, duration: float, longest_lag: float | None = None, "
              "wave_numbers: numpy.typing.ArrayLike | None = None, collective: bool = False, "
              "order: collections.abc.Sequence[typing.Literal['steinhardt', 'hexatic']] = (), "
              "order_neighbours: int = 12) -> Observables"),
      "Measures observables from now, time 0, on: run then samples the motion where that is due. A simulation "
      "that\n"
      "has run goes on as Simulation(simulation.system), whose counters start at 0.\n"
      "\n"
      "duration: planned time; the run may end earlier. longest_lag: of correlations in time; None: duration / 16.\n"
      "wave_numbers: of F_self, at most 8; None: the first peak of S(q) in this state, a quarter, half and twice of "
      "it.\n"
      "collective: True to measure F(q, t) / S(q) of all bodies, too, at these wave numbers (\"f_collective\").\n"
      "order: of bonds: any of \"steinhardt\" (\"q4\" and \"q6\") and \"hexatic\" (\"psi6\" and \"psi6_local\").\n"
      "order_neighbours: number of nearest neighbours that a body has bonds with, 4 to 50, for q4 and q6.");
}

}  // namespace

void bind_simulation_runs(Type& type) {
  bind_run(type);
  bind_changes(type);
  bind_measure(type);
}

}  // namespace hardbody::python
