#include "base/arguments.h"
#include "base/arrays.h"
#include "geometry/custom_shape.h"
#include "simulation/bind.h"
#include "simulation/observables.h"
#include "simulation/options.h"
#include "simulation/paths.h"
#include "simulation/recorded.h"
#include "simulation/simulation.h"
#include "simulation/unlocked.h"

#include <io/text_file.h>

#include <ed/simulation.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <Eigen/Core>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

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
  auto& simulation = nb::cast<PythonSimulation&>(self);
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

double compressibility(const PythonSimulation& s) {
  const ed::Simulation& simulation = s.whole();
  if (!(simulation.time() > 0)) return std::numeric_limits<double>::quiet_NaN();
  const ed::System system = simulation.system();
  const double kT = ed::kinetic_state(system).translational_kT;
  return 1 + simulation.virial() / (3.0 * system.size() * kT * simulation.time());
}

double pressure(const PythonSimulation& s) {
  const ed::System system = s.whole().system();
  const double volume = system.box * system.box * system.box;
  return compressibility(s) * system.size() * ed::kinetic_state(system).translational_kT / volume;
}

/// Returns the vectors of a snapshot.
nb::object sampled(const PythonSimulation& s, std::vector<Eigen::Vector3d> ed::Snapshot::*member) {
  ed::Snapshot snapshot;
  s.whole().sample(snapshot);
  const std::vector<Eigen::Vector3d>& list = snapshot.*member;
  const NewArray<double> made = new_array<double>({list.size(), 3});
  for (std::size_t k = 0; k < list.size(); ++k) Eigen::Vector3d::Map(made.data + 3 * k) = list[k];
  return made.array;
}

nb::object saved(const PythonSimulation& simulation, nb::handle path) {
  if (!path.is_none()) {
    write_state(path, [&](const auto& sink) { simulation.save(sink); });
    return nb::none();
  }
  std::string bytes;
  simulation.save([&bytes](std::string_view piece) { bytes += piece; });
  return nb::bytes(bytes.data(), bytes.size());
}

PythonSimulation restored(nb::handle state, nb::handle shapes) {
  std::vector<ed::CustomShape> own;
  if (!nb::isinstance<nb::list>(shapes) && !nb::isinstance<nb::tuple>(shapes)) {
    refuse_type("shapes", shapes, "a list of shapes of your own");
  }
  for (const nb::handle shape : shapes) {
    if (!is_custom_shape(shape))
      refuse_type("shapes[" + std::to_string(own.size()) + ']', shape, "a shape of your own");
    own.push_back(custom_shape_of(shape));
  }
  std::string bytes;
  if (PyBytes_Check(state.ptr()) || PyByteArray_Check(state.ptr()) || PyMemoryView_Check(state.ptr())) {
    const nb::object copy = nb::steal(PyBytes_FromObject(state.ptr()));
    if (!copy.is_valid()) throw nb::python_error();
    bytes.assign(PyBytes_AS_STRING(copy.ptr()), static_cast<std::size_t>(PyBytes_GET_SIZE(copy.ptr())));
  } else {
    bytes = read_state(state, "state");
  }
  return PythonSimulation::restore(bytes, own);
}

constexpr const char* kDoc =
    "Event-driven dynamics of hard convex bodies in a periodic cubic box: collisions are found one by one and "
    "computed\n"
    "to rounding; no contact is missed.\n"
    "\n"
    "The same system and options give the same bits, those of the program, however a run is divided into calls.\n"
    "Arrays are copies, which later runs do not change. A simulation may be used by several threads, but while it "
    "runs\n"
    "only by callbacks: others get a RuntimeError. An exception in a shape of your own leaves it within an event, and\n"
    "without a state.";

constexpr const char* kConstructorDoc =
    "Constructs a simulation that starts from a state, at time 0.\n"
    "\n"
    "envelope: thickness of the neighbour lists' envelopes, a length; None: a guess, which tune_envelopes improves.\n"
    "neighbours: 'dilated', 'obp' (the paper's) or 'cells'; None: the fastest. finder: 'certified', which never steps\n"
    "over a contact, or 'bracketing', the paper's, with its eps_d (a length; None: 1e-6 of the bodies' size), "
    "distance\n"
    "('dual', 'newton8', 'newton5') and root ('newton', 'one_dimensional'). instruction_set: of the vector kernels,\n"
    "which give the same bits; None: no vectors. prepare_from: number of bodies from which on memory is prefetched.\n"
    "least_progress: criterion of a stall (ed::SimulationOptions).\n"
    "\n"
    "Raises ValueError if bodies overlap, numbers are not finite, or the box is too small for nearest images.";

void bind_constructor(Type& type) {
  type.def(
      "__init__",
      [](PythonSimulation* self, nb::handle system, nb::handle envelope, nb::handle neighbours, nb::handle finder,
         nb::handle distance, nb::handle root, nb::handle eps_d, nb::handle instruction_set, nb::handle prepare_from,
         nb::handle least_progress) {
        const OptionArguments given{envelope, neighbours,      finder,       distance,      root,
                                    eps_d,    instruction_set, prepare_from, least_progress};
        const auto& bodies = instance<BodySystem>(system, "system");
        new (self) PythonSimulation(bodies, simulation_options(given, bodies.system));
      },
      nb::arg("system").none(), nb::kw_only(), nb::arg("envelope") = nb::none(), nb::arg("neighbours") = nb::none(),
      nb::arg("finder").none() = "certified", nb::arg("distance").none() = "dual", nb::arg("root").none() = "newton",
      nb::arg("eps_d") = nb::none(), nb::arg("instruction_set").none() = "best",
      nb::arg("prepare_from").none() = ed::SimulationOptions{}.prepare_from,
      nb::arg("least_progress").none() = ed::SimulationOptions{}.least_progress,
      nb::sig("def __init__(self, system: System, *, envelope: float | None = None, "
              "neighbours: typing.Literal['dilated', 'obp', 'cells'] | None = None, "
              "finder: typing.Literal['certified', 'bracketing'] = 'certified', "
              "distance: typing.Literal['dual', 'newton8', 'newton5'] = 'dual', "
              "root: typing.Literal['newton', 'one_dimensional'] = 'newton', eps_d: float | None = None, "
              "instruction_set: typing.Literal['best', 'portable', 'avx2', 'avx512'] | None = 'best', "
              "prepare_from: int = 15000, least_progress: float = 1e-06) -> None"),
      kConstructorDoc);
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
           "loop has returned; the simulation then has no state.")
      .def(
          "shrink_box",
          [](PythonSimulation& s, nb::handle target_box, nb::handle least_gain) {
            return s.shrink_box(positive(target_box, "target_box"), duration(least_gain, "least_gain"));
          },
          nb::arg("target_box").none(), nb::arg("least_gain").none() = 0.0,
          nb::sig("def shrink_box(self, target_box: float, least_gain: float = 0.0) -> float"),
          "Scales the box and all positions down to target_box if that causes no overlap, else so that a tenth of the\n"
          "closest pair's gap is left, and not at all by less than a fraction least_gain. Returns the new box. "
          "Velocities\n"
          "are unchanged. Needs neighbours='dilated'.")
      .def("tune_envelopes", &PythonSimulation::tune_envelopes, nb::sig("def tune_envelopes(self) -> None"),
           "Chooses the thickness of the neighbour lists' envelopes by the work that the counters show. Runs up to "
           "about\n"
           "20 collisions a body.")
      .def(
          "record_collisions",
          [](PythonSimulation& s, nb::handle number) {
            s.idle().record_collisions(
                static_cast<std::size_t>(integer(number, "number", 0, std::numeric_limits<std::int64_t>::max())));
          },
          nb::arg("number").none(), nb::sig("def record_collisions(self, number: int) -> None"),
          "Starts recording: `recorded` will hold the next `number` collisions.")
      .def(
          "measure",
          [](nb::handle self, nb::handle duration, nb::handle longest_lag, nb::handle wave_numbers) {
            auto& s = nb::cast<PythonSimulation&>(self);
            return PythonObservables{nb::borrow(self),
                                     s.measure(measuring_options(s.bodies(), duration, longest_lag, wave_numbers))};
          },
          nb::arg("duration").none(), nb::arg("longest_lag") = nb::none(), nb::arg("wave_numbers") = nb::none(),
          nb::sig("def measure(self, duration: float, longest_lag: float | None = None, "
                  "wave_numbers: numpy.typing.ArrayLike | None = None) -> Observables"),
          "Measures observables from now, time 0, on: run then samples the motion where that is due. A simulation "
          "that\n"
          "has run goes on as Simulation(simulation.system), whose counters start at 0.\n"
          "\n"
          "duration: planned time; the run may end earlier. longest_lag: of correlations in time; None: duration / 16, "
          "at\n"
          "most 40 time units of the bodies. wave_numbers: of F_self, at most 8; None: the first peak of S(q) in this\n"
          "state, a quarter, half and twice of it.");
}

void bind_arrays(Type& type) {
  const auto bind = [&](const char* name, auto get, const char* doc) {
    const std::string signature = std::string("def ") + name + "(self) -> numpy.typing.NDArray[numpy.float64]";
    type.def_prop_ro(
        name, [get](const PythonSimulation& s) { return get(s.whole().system()); },
        nb::for_getter(nb::sig(signature.c_str())), doc);
  };
  bind("positions", positions_of, "Centres of mass, wrapped into the box, whose middle is the origin, shape (N, 3).");
  bind("orientations", orientations_of, "Unit quaternions (w, x, y, z), body to world, w >= 0, shape (N, 4).");
  bind("velocities", velocities_of, "Velocities of the centres, shape (N, 3).");
  bind("angular_velocities", angular_velocities_of, "Angular velocities, world frame, shape (N, 3).");
  type.def_prop_ro(
          "unwrapped_positions", [](const PythonSimulation& s) { return sampled(s, &ed::Snapshot::position); },
          nb::for_getter(nb::sig("def unwrapped_positions(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Centres of mass, continuous across the faces of the box since the start, shape (N, 3).")
      .def_prop_ro(
          "angular_displacements", [](const PythonSimulation& s) { return sampled(s, &ed::Snapshot::phi_lab); },
          nb::for_getter(nb::sig("def angular_displacements(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Integrals of the angular velocities since the start, spin excluded, world frame, shape (N, 3).")
      .def_prop_ro("recorded", &recorded,
                   nb::for_getter(nb::sig("def recorded(self) -> numpy.typing.NDArray[numpy.void]")),
                   "Collisions recorded so far: a structured array with fields time, i, j, i < j.")
      .def_prop_ro(
          "virial_tensor", [](const PythonSimulation& s) { return array_of(s.whole().virial_tensor()); },
          nb::for_getter(nb::sig("def virial_tensor(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Sum over collisions of r_AB dp^T, whose trace is `virial`, shape (3, 3).");
}

void bind_numbers(Type& type) {
  type.def_prop_ro(
          "time", [](const PythonSimulation& s) { return s.whole().time(); }, "Time since the start.")
      .def_prop_ro(
          "box", [](const PythonSimulation& s) { return s.whole().box(); }, "Edge length of the box.")
      .def_prop_ro(
          "system", [](const PythonSimulation& s) { return s.bodies(); }, "State at this time.")
      .def_prop_ro(
          "counters", [](const PythonSimulation& s) { return s.whole().counters(); },
          "Counters of events since the start.")
      .def_prop_ro(
          "collisions", [](const PythonSimulation& s) { return s.whole().counters().collisions; },
          "Number of collisions since the start. `recorded` has those that were recorded.")
      .def_prop_ro(
          "collision_rate",
          [](const PythonSimulation& s) {
            const ed::Simulation& simulation = s.whole();
            return 2.0 * static_cast<double>(simulation.counters().collisions) /
                   (simulation.system().size() * simulation.time());
          },
          "Collisions that a body takes part in per time unit, since the start; NaN at time 0.")
      .def_prop_ro("Z", &compressibility,
                   "Compressibility factor P V / (N kT) = 1 + virial / (3 N kT time), kT the present translational\n"
                   "temperature; NaN at time 0. Observables have it with its error.")
      .def_prop_ro("pressure", &pressure, "Pressure since the start, Z N kT / V; NaN at time 0.")
      .def_prop_ro(
          "virial", [](const PythonSimulation& s) { return s.whole().virial(); },
          "Sum over collisions of r_AB . dp, dp the momentum that B gains.")
      .def(
          "kinetic", [](const PythonSimulation& s) { return s.whole().kinetic(); },
          nb::sig("def kinetic(self) -> Kinetic"), "Returns kinetic energies and temperatures.")
      .def(
          "audit",
          [](const PythonSimulation& s) {
            const ed::System system = s.whole().system();
            return unlocked([&] { return ed::audit(system); });
          },
          nb::sig("def audit(self) -> Audit"),
          "Returns the smallest distance of all pairs and overlaps, computed from scratch, as System.audit.")
      .def_prop_ro(
          "envelope", [](const PythonSimulation& s) { return s.whole().envelope(); },
          "Thickness of the neighbour lists' envelopes, a length.")
      .def_prop_ro(
          "neighbours", [](const PythonSimulation& s) { return to_string(s.options().neighbours); },
          "Kind of neighbour lists.")
      .def_prop_ro(
          "failures", [](const PythonSimulation& s) { return s.whole().failures(); },
          nb::for_getter(nb::sig("def failures(self) -> list[FailedPair]")),
          "First pairs whose prediction failed, at most 16 for each reason: none in a sound run.")
      .def_prop_ro(
          "stall", [](const PythonSimulation& s) { return s.whole().stall(); },
          nb::for_getter(nb::sig("def stall(self) -> Stall | None")), "Stall of the run; None if it has not stalled.")
      .def_prop_ro(
          "observables",
          [](nb::handle self) {
            nb::list list;
            for (const auto& m : nb::cast<const PythonSimulation&>(self).measurements()) {
              list.append(PythonObservables{nb::borrow(self), m});
            }
            return list;
          },
          nb::for_getter(nb::sig("def observables(self) -> list[Observables]")),
          "Observables that measure has begun, restored ones too.")
      .def("__len__", [](const PythonSimulation& s) { return s.whole().system().size(); })
      .def("__repr__", [](const PythonSimulation& s) {
        const ed::Simulation& simulation = s.whole();
        return "Simulation(" + std::to_string(simulation.system().size()) + " bodies, box " + shown(simulation.box()) +
               ", time " + shown(simulation.time()) + ", " + std::to_string(simulation.counters().collisions) +
               " collisions)";
      });
}

void bind_state(Type& type) {
  type.def("save", &saved, nb::arg("path") = nb::none(),
           nb::sig("def save(self, path: str | os.PathLike[str] | None = None) -> bytes | None"),
           "Saves the whole state, observables included: to a file, or as bytes that are returned. A restored "
           "simulation\n"
           "goes on bit for bit. Files replace those of the same name only when they are complete. Raises OSError.")
      .def_static("restore", &restored, nb::arg("state").none(), nb::arg("shapes") = nb::tuple(),
                  nb::sig("def restore(state: bytes | bytearray | memoryview | str | os.PathLike[str], "
                          "shapes: list[hardbody._typing.SupportShape] | tuple[hardbody._typing.SupportShape, ...] = ()) "
                          "-> Simulation"),
                  "Returns the simulation that was saved as these bytes or to this file. shapes: your own, which are "
                  "code, in the\n"
                  "order of their species.\n"
                  "\n"
                  "Raises ValueError for bytes that are no state or damaged, and for states of another version, build "
                  "or kind of\n"
                  "processor, which would go on with other bits.");
}

}  // namespace

void bind_simulations(nb::module_& module) {
  Type type(module, "Simulation", kDoc);
  bind_constructor(type);
  bind_run(type);
  bind_arrays(type);
  bind_numbers(type);
  bind_state(type);
}

}  // namespace hardbody::python
