#include "simulation/species.h"

#include "base/arrays.h"
#include "base/values.h"
#include "geometry/custom_shape.h"
#include "geometry/shapes.h"
#include "simulation/bind.h"

#include <config/keys.h>

#include <ed/random.h>
#include <ed/shape.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <array>
#include <limits>
#include <stdexcept>
#include <utility>

namespace hardbody::python {
namespace {

using ed::Species;
using Eigen::Vector3d;

constexpr const char* kInertias = "\"paper\", \"uniform\", three moments";
constexpr const char* kComponents =
    "a Species, a shape, a Polydisperse, or a list of these, species and shapes with their number: (species, number)";

/// Returns the moments of uniform density of a shape that is written in Python: it has to know them.
Vector3d own_moments(const PythonShape& shape, double mass) {
  const nb::object method = attribute(shape.object(), "inertia");
  if (PyCallable_Check(method.ptr()) == 0) {
    throw nb::type_error("inertia is missing; accepted: three moments, or a shape with a method inertia(mass)");
  }
  return finite_vector3(method(mass), "shape.inertia(mass)");
}

Species uniform(const ed::BodyShape& shape, double mass) {
  const PythonShape* own = python_shape(shape);
  if (own == nullptr) return ed::uniform_species(shape, mass);
  return {shape, mass, own_moments(*own, mass), true};
}

Species paper(const ed::BodyShape& shape, double mass) {
  const auto* ellipsoid = std::get_if<geom::Ellipsoid>(&shape);
  if (ellipsoid == nullptr) refuse_value("inertia", "\"paper\"", "\"uniform\" or three moments for this shape");
  return ed::paper_species(*ellipsoid, mass);
}

Species with_inertia(const ed::BodyShape& shape, double mass, nb::handle inertia) {
  if (inertia.is_none()) return ed::is_spheroid(shape) ? paper(shape, mass) : uniform(shape, mass);
  if (!nb::isinstance<nb::str>(inertia)) {
    return {shape, mass, finite_vector3(inertia, "inertia"), true};
  }
  const std::string_view word = text(inertia, "inertia", kInertias);
  if (word == "paper") return paper(shape, mass);
  if (word == "uniform") return uniform(shape, mass);
  refuse_value("inertia", '"' + std::string(word) + '"', kInertias);
}

/// Constructs a species; `name` is the shape's in messages.
Species make_species(nb::handle shape, const std::string& name, nb::handle mass, nb::handle inertia, nb::handle spins) {
  const ed::BodyShape body = body_shape(shape, name);
  const PythonShape* own = python_shape(body);
  if (own != nullptr && !own->has_volume()) {
    throw nb::type_error(
        (name + ".volume is missing; accepted: a volume above 0, here or in CustomShape(shape, volume=...)").c_str());
  }
  Species species = with_inertia(body, positive(mass, "mass"), inertia);
  if (!spins.is_none()) species.spins = truth(spins, "spins", "True, False, None");
  ed::check_species(species);
  return species;
}

std::string species_text(const Species& s) {
  return "Species(" + nb::cast<std::string>(nb::repr(shape_object(s.shape))) + ", mass=" + shown(s.mass) +
         ", inertia=" + shown(s.inertia) + ", spins=" + (s.spins ? "True" : "False") + ')';
}

bool same_species(const Species& a, const Species& b) {
  return shape_object(a.shape).equal(shape_object(b.shape)) && a.mass == b.mass && a.inertia == b.inertia &&
         a.spins == b.spins;
}

int body_count(nb::handle value, const char* name) {
  return static_cast<int>(integer(value, name, 1, kMostBodies));
}

constexpr std::array kDistributions = {ed::SizeDistribution::uniform, ed::SizeDistribution::gaussian,
                                       ed::SizeDistribution::lognormal};

Polydisperse make_polydisperse(nb::handle species, nb::handle number, nb::handle width, nb::handle sizes,
                               nb::handle seed) {
  Polydisperse made;
  made.species = species_of(species, "species");
  if (python_shape(made.species.shape) != nullptr) {
    throw nb::type_error("species has a shape of your own, which cannot be scaled; accepted: built-in shapes");
  }
  made.number = body_count(number, "number");
  made.width = python::number(width, "width");
  made.sizes = choice(sizes, "sizes", kDistributions);
  if (!seed.is_none()) made.seed = seed_of(seed, "seed");
  static_cast<void>(ed::draw_sizes(made.sizes, made.width, 0, 0));  // refuses the width
  return made;
}

using Groups = std::vector<ComponentGroup>;

/// Adds bodies of distributed sizes: each species of a start has a stream of random numbers of its own.
void add(Groups& groups, const Polydisperse& bodies, std::uint64_t seed) {
  ed::Random streams(bodies.seed.value_or(seed));
  for (std::size_t skip = 0; skip < groups.size(); ++skip) streams.bits();
  std::vector<double> factors = ed::draw_sizes(bodies.sizes, bodies.width, bodies.number, streams.bits());
  groups.push_back({bodies.species, bodies.number, std::move(factors)});
}

void add_entry(Groups& groups, nb::handle one, const std::string& name, std::uint64_t seed) {
  Polydisperse* bodies = nullptr;
  if (nb::try_cast(one, bodies, false) && bodies != nullptr) return add(groups, *bodies, seed);
  const bool is_pair = (nb::isinstance<nb::tuple>(one) || nb::isinstance<nb::list>(one)) && nb::len(one) == 2;
  if (!is_pair) refuse_type(name, one, "(species, number) or a Polydisperse");
  groups.push_back({species_of(one[0], entry(name, 0)), body_count(one[1], entry(name, 1).c_str()), {}});
}

void refuse_number(nb::handle number) {
  if (!number.is_none()) refuse_type("number", number, "None, where components have numbers of their own");
}

}  // namespace

std::vector<ed::Component> component_list(const Groups& groups) {
  std::vector<ed::Component> list;
  for (const ComponentGroup& g : groups) {
    if (g.factors.empty()) list.push_back({g.species, g.number});
    for (const double factor : g.factors) list.push_back({ed::scaled(g.species, factor), 1});
  }
  return list;
}

std::vector<int> numbers_of(const Groups& groups) {
  std::vector<int> numbers;
  for (const ComponentGroup& g : groups) numbers.push_back(g.number);
  return numbers;
}

Species species_of(nb::handle value, const std::string& name) {
  Species* found = nullptr;
  if (nb::try_cast(value, found, false) && found != nullptr) return *found;
  const nb::object none = nb::none();
  if (is_custom_shape(value)) return make_species(value, name, nb::float_(1.0), none, none);
  refuse_type(name, value, "a Species or a shape");
}

bool is_species(nb::handle value) {
  return nb::isinstance<Species>(value) || is_custom_shape(value);
}

std::vector<ComponentGroup> components_of(nb::handle value, nb::handle number, std::uint64_t seed, int usual_number) {
  Groups groups;
  Polydisperse* bodies = nullptr;
  if (nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value)) {
    refuse_number(number);
    std::size_t k = 0;
    for (const nb::handle one : value) add_entry(groups, one, entry("components", k++), seed);
  } else if (nb::try_cast(value, bodies, false) && bodies != nullptr) {
    refuse_number(number);
    add(groups, *bodies, seed);
  } else if (is_species(value)) {
    const int count = number.is_none() ? usual_number : static_cast<int>(integer(number, "number", 2, kMostBodies));
    groups.push_back({species_of(value, "components"), count, {}});
  } else {
    refuse_type("components", value, kComponents);
  }
  std::int64_t sum = 0;
  for (const ComponentGroup& g : groups) sum += g.number;
  if (sum < 2 || sum > kMostBodies) {
    refuse_value("number of bodies", std::to_string(sum), "2 to " + std::to_string(kMostBodies));
  }
  return groups;
}

std::uint64_t seed_of(nb::handle value, const char* name) {
  return static_cast<std::uint64_t>(integer(value, name, 0, std::numeric_limits<std::int64_t>::max()));
}

namespace {

void bind_one_species(nb::module_& module) {
  nb::class_<Species> type(module, "Species", nb::is_weak_referenceable(),
                           "Shape, mass and moments of inertia of bodies of one kind.");
  type.def(
          "__init__",
          [](Species* self, nb::handle shape, nb::handle mass, nb::handle inertia, nb::handle spins) {
            new (self) Species(make_species(shape, "shape", mass, inertia, spins));
          },
          nb::arg("shape").none(), nb::arg("mass").none() = 1.0, nb::arg("inertia") = nb::none(),
          nb::arg("spins") = nb::none(),
          nb::sig("def __init__(self, shape: hardbody.BodyShape, mass: float = 1.0, "
                  "inertia: typing.Literal['paper', 'uniform'] | numpy.typing.ArrayLike | None = None, "
                  "spins: bool | None = None) -> None"),
          "Constructs a species.\n"
          "\n"
          "inertia: principal moments about body x, y, z, shape (3,); 'uniform': those of uniform density; 'paper', "
          "for\n"
          "ellipsoids of revolution: 2/5 mass min(a, b)^2 across the axis, and no spin about it. None: 'paper' for\n"
          "ellipsoids of revolution, 'uniform' for others. spins: False: no angular velocity about the axis of\n"
          "revolution, which contacts would never change; None: as `inertia` has it.\n"
          "\n"
          "Raises ValueError unless mass and moments are physically possible, and for exponents below 0.25 or above\n"
          "1.6.")
      .def_prop_ro(
          "shape", [](const Species& s) { return shape_object(s.shape); },
          nb::for_getter(nb::sig("def shape(self) -> hardbody.Shape | CustomShape")), "Shape of the bodies.")
      .def_prop_ro(
          "mass", [](const Species& s) { return s.mass; }, "Mass of a body.")
      .def_prop_ro(
          "inertia", [](const Species& s) { return array_of(s.inertia); },
          nb::for_getter(nb::sig("def inertia(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Principal moments of inertia about body x, y, z, shape (3,).")
      .def_prop_ro(
          "spins", [](const Species& s) { return s.spins; }, "Whether bodies turn about their axis of revolution.")
      .def_prop_ro(
          "symmetry_axis", [](const Species& s) { return ed::symmetry_axis(s); },
          "Index (0, 1, 2) of the body axis that shape and inertia are both symmetric about; None: there is none.")
      .def(
          "scaled", [](const Species& s, nb::handle factor) { return ed::scaled(s, positive(factor, "factor")); },
          nb::arg("factor").none(), nb::sig("def scaled(self, factor: float) -> Species"),
          "Returns a species of `factor` times the size and the same density. Built-in shapes only.")
      .def("__repr__", &species_text)
      .def(
          "__reduce__",
          [](nb::handle self) {
            const auto& s = nb::cast<const Species&>(self);
            return nb::make_tuple(self.type(),
                                  nb::make_tuple(shape_object(s.shape), s.mass, array_of(s.inertia), s.spins));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
  bind_equality(type, same_species);
}

void bind_polydisperse(nb::module_& module) {
  nb::class_<Polydisperse> type(module, "Polydisperse", nb::is_weak_referenceable(),
                                "Bodies of one species whose sizes are distributed.");
  type.def(
          "__init__",
          [](Polydisperse* self, nb::handle species, nb::handle number, nb::handle width, nb::handle sizes,
             nb::handle seed) { new (self) Polydisperse(make_polydisperse(species, number, width, sizes, seed)); },
          nb::arg("species").none(), nb::arg("number").none(), nb::arg("width").none(),
          nb::arg("sizes").none() = "gaussian", nb::arg("seed") = nb::none(),
          nb::sig("def __init__(self, species: Species | hardbody.Shape, number: int, width: float, "
                  "sizes: typing.Literal['uniform', 'gaussian', 'lognormal'] = 'gaussian', seed: int | None = None) "
                  "-> None"),
          "Constructs `number` bodies whose sizes, relative to the species, have mean 1 and standard deviation "
          "`width`:\n"
          "above 0, at most 0.5 ('gaussian', cut off at three standard deviations: 0.3). Densities are equal. seed:\n"
          "that of the sizes; None: that of the start. The program draws the same sizes.")
      .def_ro("species", &Polydisperse::species, "Species of nominal size.")
      .def_ro("number", &Polydisperse::number, "Number of bodies.")
      .def_ro("width", &Polydisperse::width, "Standard deviation over mean of the sizes.")
      .def_prop_ro(
          "sizes", [](const Polydisperse& p) { return to_string(p.sizes); }, "Name of the distribution.")
      .def_prop_ro(
          "seed", [](const Polydisperse& p) { return p.seed; }, "Seed of the sizes; None: that of the start.")
      .def("__repr__",
           [](const Polydisperse& p) {
             return "Polydisperse(" + species_text(p.species) + ", number=" + std::to_string(p.number) +
                    ", width=" + shown(p.width) + ", sizes='" + to_string(p.sizes) + "')";
           })
      .def(
          "__reduce__",
          [](nb::handle self) {
            const auto& p = nb::cast<const Polydisperse&>(self);
            return nb::make_tuple(self.type(),
                                  nb::make_tuple(p.species, p.number, p.width, to_string(p.sizes), p.seed));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
  bind_equality(type, [](const Polydisperse& a, const Polydisperse& b) {
    return same_species(a.species, b.species) && a.number == b.number && a.width == b.width && a.sizes == b.sizes &&
           a.seed == b.seed;
  });
}

}  // namespace

void bind_species(nb::module_& module) {
  bind_one_species(module);
  bind_polydisperse(module);
}

}  // namespace hardbody::python
