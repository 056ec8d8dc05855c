#include "base/arguments.h"
#include "base/arrays.h"
#include "base/unlocked.h"
#include "simulation/bind.h"
#include "simulation/observables.h"
#include "simulation/simulation.h"

#include <ed/simulation.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace hardbody::python {
namespace {

using Type = nb::class_<PythonSimulation>;

/// Returns kT by all energy that collisions exchange, which is conserved: that of translation alone fluctuates by
/// about sqrt(2 / (3 N)). Spheres keep their rotation, and bodies of revolution their spin.
double conserved_kT(const ed::System& system) {
  ed::System turning = system;
  std::erase_if(turning.bodies, [&](const ed::Body& body) {
    return ed::is_sphere(system.species[static_cast<std::size_t>(body.species)].shape);
  });
  const ed::KineticState rotation = ed::kinetic_state(turning);
  const double energy = ed::kinetic_state(system).translational_energy + rotation.rotational_energy;
  return 2 * energy / std::max(1, 3 * system.size() - 3 + rotation.rotational_degrees_of_freedom);
}

/// Compressibility factor and pressure since the start; NaN at time 0.
struct EquationOfState {
  explicit EquationOfState(const ed::Simulation& simulation) {
    if (!(simulation.time() > 0)) return;
    const ed::System system = simulation.system();
    const double NkT = system.size() * conserved_kT(system);
    Z = 1 + simulation.virial() / (3 * NkT * simulation.time());
    pressure = Z * NkT / (system.box * system.box * system.box);
  }

  double Z = std::numeric_limits<double>::quiet_NaN();
  double pressure = std::numeric_limits<double>::quiet_NaN();
};

/// Returns the vectors of a snapshot.
nb::object sampled(const PythonSimulation& s, std::vector<Eigen::Vector3d> ed::Snapshot::*member) {
  ed::Snapshot snapshot;
  s.whole().sample(snapshot);
  const std::vector<Eigen::Vector3d>& list = snapshot.*member;
  const NewArray<double> made = new_array<double>({list.size(), 3});
  for (std::size_t k = 0; k < list.size(); ++k) Eigen::Vector3d::Map(made.data + 3 * k) = list[k];
  return made.array;
}

/// Returns the recorded collisions as a structured array.
nb::object recorded(const PythonSimulation& simulation) {
  const std::vector<ed::Collision>& list = simulation.whole().collisions();
  static_assert(sizeof(ed::Collision) == 16);
  const NewArray<std::uint8_t> bytes = new_array<std::uint8_t>({sizeof(ed::Collision) * list.size()});
  if (!list.empty()) std::memcpy(bytes.data, list.data(), sizeof(ed::Collision) * list.size());
  nb::list fields;
  fields.append(nb::make_tuple("time", "f8"));
  fields.append(nb::make_tuple("i", "i4"));
  fields.append(nb::make_tuple("j", "i4"));
  return bytes.array.attr("view")(nb::module_::import_("numpy").attr("dtype")(fields));
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
      .def_prop_ro(
          "Z", [](const PythonSimulation& s) { return EquationOfState(s.whole()).Z; },
          "Compressibility factor P V / (N kT) = 1 + virial / (3 N kT time), kT by the conserved energy of all\n"
          "motion that collisions exchange; NaN at time 0. Observables have it with its error.")
      .def_prop_ro(
          "pressure", [](const PythonSimulation& s) { return EquationOfState(s.whole()).pressure; },
          "Pressure since the start, Z N kT / V; NaN at time 0.");
}

void bind_mechanics(Type& type) {
  type.def_prop_ro(
          "virial", [](const PythonSimulation& s) { return s.whole().virial(); },
          "Sum over collisions of r_AB . dp, dp the momentum that B gains.")
      .def(
          "kinetic", [](const PythonSimulation& s) { return s.whole().kinetic(); },
          nb::sig("def kinetic(self) -> Kinetic"), "Returns kinetic energies and temperatures.")
      .def(
          "audit",
          [](const PythonSimulation& s) {
            const ed::System system = s.whole().system();
            return unlocked([&] { return ed::audit(system, InterruptPoll()); });
          },
          nb::sig("def audit(self) -> Audit"),
          "Returns the smallest distance of all pairs and overlaps, computed from scratch, as System.audit.");
}

void bind_outcome(Type& type) {
  type.def_prop_ro(
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
            for (const auto& m : instance<PythonSimulation>(self, "self").measurements()) {
              list.append(PythonObservables{nb::borrow(self), m});
            }
            return list;
          },
          nb::for_getter(nb::sig("def observables(self) -> list[Observables]")),
          "Observables that measure has begun, restored ones too.")
      .def("__len__", [](const PythonSimulation& s) { return s.whole().system().size(); })
      .def("__repr__", [](const PythonSimulation& s) {
        if (const std::string trouble = s.trouble(); !trouble.empty()) return "Simulation(" + trouble + ')';
        const ed::Simulation& simulation = s.whole();
        return "Simulation(" + std::to_string(simulation.system().size()) + " bodies, box " + shown(simulation.box()) +
               ", time " + shown(simulation.time()) + ", " + std::to_string(simulation.counters().collisions) +
               " collisions)";
      });
}

}  // namespace

void bind_simulation_numbers(Type& type) {
  bind_arrays(type);
  bind_numbers(type);
  bind_mechanics(type);
  bind_outcome(type);
}

}  // namespace hardbody::python
