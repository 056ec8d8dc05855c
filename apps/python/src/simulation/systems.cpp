#include "simulation/systems.h"

#include "base/arrays.h"
#include "base/unlocked.h"
#include "base/values.h"
#include "simulation/bind.h"
#include "simulation/read_system.h"
#include "simulation/species.h"

#include <ed/random.h>
#include <ed/start.h>
#include <geom/pose.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace hardbody::python {
namespace {

using Eigen::Vector3d;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Returns an array of shape (N, columns) whose rows `fill` writes.
template <class Fill>
nb::object rows_of(const ed::System& system, std::vector<std::size_t> row_shape, std::size_t columns, Fill fill) {
  row_shape.insert(row_shape.begin(), system.bodies.size());
  const NewArray<double> made = new_array<double>(row_shape);
  for (std::size_t k = 0; k < system.bodies.size(); ++k) fill(system.bodies[k], made.data + columns * k);
  return made.array;
}

nb::object vectors_of(const ed::System& system, Vector3d ed::Body::*member) {
  return rows_of(system, {3}, 3, [member](const ed::Body& body, double* out) { Vector3d::Map(out) = body.*member; });
}

nb::object species_indices(const ed::System& system) {
  const NewArray<std::int64_t> made = new_array<std::int64_t>({system.bodies.size()});
  for (std::size_t k = 0; k < system.bodies.size(); ++k) made.data[k] = system.bodies[k].species;
  return made.array;
}

/// Draws Maxwell's velocities, rescaled to kT = 1 exactly.
BodySystem thermalized(const BodySystem& bodies, nb::handle seed) {
  BodySystem made = bodies;
  ed::System& system = made.system;
  ed::Random random(seed_of(seed, "seed"));
  for (int i = 0; i < system.size(); ++i) {
    ed::Body& body = system.bodies[static_cast<std::size_t>(i)];
    const ed::Species& species = system.species_of(i);
    body.velocity = random.normal3() / std::sqrt(species.mass);
    Vector3d omega = random.normal3().cwiseQuotient(species.inertia.cwiseSqrt());
    if (const std::optional<int> axis = ed::symmetry_axis(species); axis && !species.spins) omega[*axis] = 0;
    body.angular_velocity = body.rotation * omega;
  }
  ed::rescale_velocities(system, made.groups);
  return made;
}

std::string system_text(const BodySystem& b) {
  const std::size_t species = b.system.species.size();
  return "System(" + std::to_string(b.system.size()) + " bodies of " + std::to_string(species) + " species, box " +
         shown(b.system.box) + ", packing fraction " + shown(ed::packing_fraction(b.system)) + ')';
}

nb::tuple constructor_arguments(const BodySystem& b) {
  nb::list species;
  for (const ed::Species& s : b.system.species) species.append(s);
  return nb::make_tuple(b.system.box, species, positions_of(b.system), rotations_of(b.system), velocities_of(b.system),
                        angular_velocities_of(b.system), species_indices(b.system), b.groups);
}

bool same_body(const ed::Body& a, const ed::Body& b) {
  return a.position == b.position && a.rotation == b.rotation && a.velocity == b.velocity &&
         a.angular_velocity == b.angular_velocity && a.species == b.species;
}

bool same_system(const BodySystem& a, const BodySystem& b) {
  const auto same_species = [](const ed::Species& s, const ed::Species& t) { return nb::cast(s).equal(nb::cast(t)); };
  return a.system.box == b.system.box && a.groups == b.groups &&
         std::ranges::equal(a.system.bodies, b.system.bodies, same_body) &&
         std::ranges::equal(a.system.species, b.system.species, same_species);
}

constexpr const char* kReals = "-> numpy.typing.NDArray[numpy.float64]";

/// Defines an attribute that is an array.
template <class F>
void bind_array(nb::class_<BodySystem>& type, const char* name, F get, const char* doc) {
  const std::string signature = std::string("def ") + name + "(self) " + kReals;
  type.def_prop_ro(
      name, [get](const BodySystem& b) { return get(b.system); }, nb::for_getter(nb::sig(signature.c_str())), doc);
}

void bind_constructor(nb::class_<BodySystem>& type) {
  type.def(
      "__init__",
      [](BodySystem* self, nb::handle box, nb::handle species, nb::handle positions, nb::handle orientations,
         nb::handle velocities, nb::handle angular_velocities, nb::handle species_of_body, nb::handle groups) {
        new (self) BodySystem(make_system(
            {box, species, positions, orientations, velocities, angular_velocities, species_of_body, groups}));
      },
      nb::arg("box").none(), nb::arg("species").none(), nb::arg("positions").none(),
      nb::arg("orientations") = nb::none(), nb::arg("velocities") = nb::none(),
      nb::arg("angular_velocities") = nb::none(), nb::arg("species_of") = nb::none(), nb::arg("groups") = nb::none(),
      nb::sig("def __init__(self, box: float, species: hardbody.SpeciesLike | "
              "collections.abc.Sequence[hardbody.SpeciesLike], positions: numpy.typing.ArrayLike, "
              "orientations: numpy.typing.ArrayLike | hardbody.RotationLike | None = None, "
              "velocities: numpy.typing.ArrayLike | None = None, "
              "angular_velocities: numpy.typing.ArrayLike | None = None, species_of: numpy.typing.ArrayLike | None = "
              "None, groups: numpy.typing.ArrayLike | None = None) -> None"),
      "Constructs a state of N bodies in a cubic box.\n"
      "\n"
      "box: edge length. species: a Species or a shape (then of mass 1), or a list of them. positions: centres of "
      "mass,\n"
      "shape (N, 3), anywhere: images are equivalent. orientations, body to world: unit quaternions (w, x, y, z),\n"
      "shape (N, 4), of SciPy's rotations as_quat(scalar_first=True) or the rotations themselves; or rotation\n"
      "matrices, shape (N, 3, 3); None: not rotated. velocities, angular_velocities: world frame, shape (N, 3);\n"
      "None: at rest (see thermalized). species_of: index of each body's species, shape (N,); None: there is one\n"
      "species, or one a body. groups: numbers of bodies of consecutive groups, whose temperatures are set and whose\n"
      "observables are measured separately; None: runs of bodies of one species, but one group of all where species\n"
      "alternate or each body has its own.\n"
      "\n"
      "Raises ValueError for numbers that are not finite, orientations that are not unit within 1e-6, and rotation of\n"
      "bodies of revolution about their axes unless they spin (Species). Overlaps are not looked for here, but by\n"
      "audit and by Simulation.");
}

void bind_numbers(nb::class_<BodySystem>& type) {
  type.def("__len__", [](const BodySystem& b) { return b.system.bodies.size(); })
      .def_prop_ro(
          "box", [](const BodySystem& b) { return b.system.box; }, "Edge length of the cubic box.")
      .def_prop_ro(
          "species", [](const BodySystem& b) { return b.system.species; },
          nb::for_getter(nb::sig("def species(self) -> list[Species]")),
          "Species of the bodies; in a polydisperse\n"
          "system one a body.")
      .def_prop_ro(
          "species_of", [](const BodySystem& b) { return species_indices(b.system); },
          nb::for_getter(nb::sig("def species_of(self) -> numpy.typing.NDArray[numpy.int64]")),
          "Index of each body's species, shape (N,).")
      .def_prop_ro(
          "groups", [](const BodySystem& b) { return b.groups; },
          nb::for_getter(nb::sig("def groups(self) -> list[int]")), "Numbers of bodies of consecutive groups.");
  bind_array(type, "positions", positions_of, "Centres of mass, shape (N, 3), a new array at each access.");
  bind_array(type, "orientations", orientations_of,
             "Unit quaternions (w, x, y, z), body to world, w >= 0, shape (N, 4).");
  bind_array(type, "rotations", rotations_of,
             "Rotation matrices, body to world, shape (N, 3, 3): the state's own bits, which quaternions lose.");
  bind_array(type, "velocities", velocities_of, "Velocities of the centres, shape (N, 3).");
  bind_array(type, "angular_velocities", angular_velocities_of, "Angular velocities, world frame, shape (N, 3).");
}

void bind_functions(nb::class_<BodySystem>& type) {
  type.def_prop_ro(
          "packing_fraction", [](const BodySystem& b) { return ed::packing_fraction(b.system); },
          "Volume of the bodies over that of the box.")
      .def_prop_ro(
          "nematic_order", [](const BodySystem& b) { return nematic_order_of(b.system); },
          "Largest eigenvalue of Q = 3/2 <u u^T> - 1/2, u the bodies' axes of revolution or, without one, body z.")
      .def_prop_ro(
          "time_unit", [](const BodySystem& b) { return ed::time_unit(b.system); },
          "Mean thermal time of the bodies, rounded to a power of two: 1 for masses 1 and volumes of the unit sphere.")
      .def(
          "audit",
          [](const BodySystem& b) {
            check_interrupts();
            return unlocked([&] { return ed::audit(b.system, InterruptPoll()); });
          },
          nb::sig("def audit(self) -> Audit"),
          "Returns the smallest distance of all pairs, overlaps and the kinetic state, computed from scratch by "
          "distance\n"
          "alone. Distances are accurate to 1e-13 of the size of a pair. The GIL is released.")
      .def(
          "kinetic", [](const BodySystem& b) { return ed::kinetic_state(b.system); },
          nb::sig("def kinetic(self) -> Kinetic"), "Returns kinetic energies and temperatures.")
      .def(
          "thermalized", &thermalized, nb::arg("seed").none() = 1,
          nb::sig("def thermalized(self, seed: int = 1) -> System"),
          "Returns the state with new velocities: drawn from Maxwell's distribution, then rescaled to kT = 1 exactly,\n"
          "each group by itself, and to total momentum 0.")
      .def("__repr__", &system_text)
      .def(
          "__reduce__",
          [](nb::handle self) {
            return nb::make_tuple(self.type(), constructor_arguments(nb::cast<const BodySystem&>(self)));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
}

}  // namespace

std::vector<int> groups_of(const ed::System& system) {
  std::vector<int> groups;
  const std::size_t n = system.bodies.size();
  bool one_each = n > 0 && system.species.size() == n;
  for (std::size_t k = 0; k < n; ++k) {
    const bool same = k > 0 && system.bodies[k].species == system.bodies[k - 1].species;
    if (same) {
      ++groups.back();
    } else {
      groups.push_back(1);
    }
  }
  one_each = one_each && groups.size() == n;
  const bool scattered = groups.size() > system.species.size();
  if (one_each || scattered) return {static_cast<int>(n)};
  return groups;
}

std::vector<ed::BodyGroup> body_groups(const BodySystem& bodies) {
  std::vector<ed::BodyGroup> list;
  int first = 0;
  for (const int number : bodies.groups) {
    const auto axes = [&](int i) { return ed::symmetry_axis(bodies.system.species_of(i)) ? 2 : 3; };
    for (int i = first + 1; i < first + number; ++i) {
      if (axes(i) == axes(first)) continue;
      throw nb::value_error(("groups: bodies " + std::to_string(first) + " and " + std::to_string(i) +
                             " are in one group, but one is of revolution and the other is not; accepted: groups of "
                             "one kind, whose bodies follow each other")
                                .c_str());
    }
    bool oriented = false;
    for (int i = first; i < first + number; ++i) {
      oriented = oriented || !ed::is_sphere(bodies.system.species_of(i).shape);
    }
    list.push_back({number, number > 0 ? axes(first) : 2, oriented});
    first += number;
  }
  return list;
}

nb::object positions_of(const ed::System& system) {
  return vectors_of(system, &ed::Body::position);
}

nb::object orientations_of(const ed::System& system) {
  return rows_of(system, {4}, 4, [](const ed::Body& body, double* out) {
    std::ranges::copy(geom::kernel::quaternion_of(body.rotation), out);
  });
}

nb::object rotations_of(const ed::System& system) {
  return rows_of(system, {3, 3}, 9, [](const ed::Body& body, double* out) { RowMajor3::Map(out) = body.rotation; });
}

nb::object velocities_of(const ed::System& system) {
  return vectors_of(system, &ed::Body::velocity);
}

nb::object angular_velocities_of(const ed::System& system) {
  return vectors_of(system, &ed::Body::angular_velocity);
}

double nematic_order_of(const ed::System& system) {
  std::vector<Vector3d> axes;
  axes.reserve(system.bodies.size());
  for (int i = 0; i < system.size(); ++i) {
    const int axis = ed::symmetry_axis(system.species_of(i)).value_or(2);
    axes.emplace_back(system.bodies[static_cast<std::size_t>(i)].rotation.col(axis));
  }
  return ed::nematic_order(axes);
}

void bind_systems(nb::module_& module) {
  nb::class_<BodySystem> type(module, "System", nb::is_weak_referenceable(),
                              "State of bodies in a periodic cubic box. It does not change; arrays are copies.");
  bind_constructor(type);
  bind_numbers(type);
  bind_functions(type);
  bind_equality(type, same_system);
}

}  // namespace hardbody::python
