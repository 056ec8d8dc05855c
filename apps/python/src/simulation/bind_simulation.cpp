#include "base/arguments.h"
#include "base/arrays.h"
#include "base/values.h"
#include "geometry/custom_shape.h"
#include "simulation/bind.h"
#include "simulation/options.h"
#include "simulation/paths.h"
#include "simulation/simulation.h"

#include <io/text_file.h>

#include <ed/simulation.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace hardbody::python {
namespace {

using Type = nb::class_<PythonSimulation>;

void save_to_file(const PythonSimulation& simulation, nb::handle path) {
  write_state(path, [&](const auto& sink) { simulation.save(sink); });
}

nb::bytes saved_bytes(const PythonSimulation& simulation, nb::handle) {
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
    if (!is_custom_shape(shape)) refuse_type(entry("shapes", own.size()), shape, "a shape of your own");
    own.push_back(custom_shape_of(shape));
  }
  std::string bytes;
  if (PyBytes_Check(state.ptr()) || PyByteArray_Check(state.ptr()) || PyMemoryView_Check(state.ptr())) {
    const nb::object copy = nb::steal(PyBytes_FromObject(state.ptr()));
    if (!copy.is_valid()) throw nb::python_error();
    bytes.assign(PyBytes_AsString(copy.ptr()), static_cast<std::size_t>(PyBytes_Size(copy.ptr())));
  } else {
    if (!PyUnicode_Check(state.ptr()) && !nb::hasattr(state, "__fspath__")) {
      refuse_type("state", state, "bytes, a bytearray or a memoryview; or a str or path of a file");
    }
    bytes = read_state(state, "state");
  }
  return PythonSimulation::restore(bytes, own);
}

constexpr const char* kSimulationDoc =
    "Event-driven dynamics of hard convex bodies in a periodic cubic box: collisions are found one by one and "
    "computed\n"
    "to rounding; no contact is missed.\n"
    "\n"
    "The same system and options give the same bits, those of the program, however a run is divided into calls.\n"
    "Arrays are copies, which later runs do not change. A simulation may be used by several threads, but while it "
    "runs\n"
    "only by callbacks: others get a RuntimeError. After an exception in a shape of your own the simulation cannot be\n"
    "used: restore a saved state.";

constexpr const char* kConstructorDoc =
    "Constructs a simulation that starts from a state, at time 0.\n"
    "\n"
    "envelope: thickness of the neighbour lists' envelopes, a length; None: a guess, which tune_envelopes improves.\n"
    "neighbours: 'dilated', 'obp' (the paper's) or 'cells', which have no envelopes; None: the fastest. finder:\n"
    "'certified', which never steps over a contact, or 'bracketing', the paper's, with its eps_d (a length; None: "
    "1e-6\n"
    "of the bodies' size), distance ('dual', 'newton8', 'newton5') and root ('newton', 'one_dimensional'; None:\n"
    "'newton'). instruction_set: of the vector kernels, which give the same bits; None: no vectors. prepare_from:\n"
    "number of bodies from which on memory is prefetched, for the same bits.\n"
    "least_progress: criterion of a stall (ed::SimulationOptions).\n"
    "\n"
    "Raises ValueError if bodies overlap, numbers are not finite, the box is too small for nearest images or for the\n"
    "envelope, or an option has no effect with the others.";

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
      nb::arg("finder").none() = "certified", nb::arg("distance").none() = "dual", nb::arg("root") = nb::none(),
      nb::arg("eps_d") = nb::none(), nb::arg("instruction_set").none() = "best",
      nb::arg("prepare_from").none() = ed::SimulationOptions{}.prepare_from,
      nb::arg("least_progress").none() = ed::SimulationOptions{}.least_progress,
      nb::sig("def __init__(self, system: System, *, envelope: float | None = None, "
              "neighbours: typing.Literal['dilated', 'obp', 'cells'] | None = None, "
              "finder: typing.Literal['certified', 'bracketing'] = 'certified', "
              "distance: typing.Literal['dual', 'newton8', 'newton5'] = 'dual', "
              "root: typing.Literal['newton', 'one_dimensional'] | None = None, eps_d: float | None = None, "
              "instruction_set: typing.Literal['best', 'portable', 'avx2', 'avx512'] | None = 'best', "
              "prepare_from: int = 15000, least_progress: float = 1e-06) -> None"),
      kConstructorDoc);
}

void bind_state(Type& type) {
  // Two overloads, so that type checkers know what is returned. The first takes anything but None.
  type.def("save", &save_to_file, nb::arg("path"), nb::sig("def save(self, path: str | os.PathLike[str]) -> None"),
           "Saves the whole state, observables included, to a file, which replaces one of the same name only when it "
           "is\n"
           "complete. A restored simulation goes on bit for bit. Raises OSError.")
      .def("save", &saved_bytes, nb::arg("path") = nb::none(), nb::sig("def save(self, path: None = None) -> bytes"),
           "Returns the whole state, observables included, as bytes.")
      .def_static("restore", &restored, nb::arg("state").none(), nb::arg("shapes") = nb::tuple(),
                  nb::sig("def restore(state: bytes | bytearray | memoryview | str | os.PathLike[str], "
                          "shapes: list[hardbody.SupportShape] | tuple[hardbody.SupportShape, ...] = ()) "
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
  Type type(module, "Simulation", nb::is_weak_referenceable(), kSimulationDoc);
  bind_constructor(type);
  bind_simulation_runs(type);
  bind_simulation_numbers(type);
  bind_state(type);
  refuse_pickling(type, "a Simulation", "the bytes of save(), of which Simulation.restore makes a simulation");
}

}  // namespace hardbody::python
