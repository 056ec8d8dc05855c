#include "base/arguments.h"
#include "base/gil.h"
#include "base/unlocked.h"
#include "geometry/custom_shape.h"
#include "simulation/bind.h"
#include "simulation/outcomes.h"
#include "simulation/species.h"
#include "simulation/systems.h"

#include <ed/simulation.h>
#include <ed/start.h>

#include <nanobind/nanobind.h>

#include <array>
#include <exception>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hardbody::python {
namespace {

constexpr std::array kLattices = {ed::Lattice::simple_cubic, ed::Lattice::fcc};

std::optional<double> optional_number(nb::handle value, const char* name) {
  if (value.is_none()) return std::nullopt;
  return number(value, name);
}

/// Reports of a compression's progress to Python, which may end it: by Ctrl-C, by an exception, by returning False.
class ProgressReport {
 public:
  explicit ProgressReport(nb::handle callable) : callable_(callable) {
    if (!callable.is_none() && PyCallable_Check(callable.ptr()) == 0) {
      refuse_type("progress", callable, "a function of the packing fraction, or None");
    }
  }

  /// Called without the GIL; false ends the compression.
  bool operator()(double packing_fraction) {
    if (!ticks_.due()) return true;
    const GilAcquired gil;
    try {
      check_interrupts();
      if (callable_.is_none()) return true;
      is_stopped_ = ends_run(callable_(packing_fraction));
      return !is_stopped_;
    } catch (...) {
      failure_ = std::current_exception();
      return false;
    }
  }

  /// Throws what Python has thrown; to be called when a compression has ended with an exception.
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
    if (is_stopped_) throw std::runtime_error("the start was stopped: progress returned False");
  }

 private:
  nb::handle callable_;
  Ticks ticks_;
  std::exception_ptr failure_;
  bool is_stopped_ = false;
};

/// Returns make(progress, counters, failures), called without the GIL. Throws NumericalError if bodies overlapped.
template <class Make>
ed::System compress(nb::handle progress, const Make& make) {
  ProgressReport report(progress);
  ed::Counters counters;
  std::vector<ed::FailedPair> failures;
  ed::System system;
  check_interrupts();
  try {
    system = unlocked([&] { return make([&report](double packing) { return report(packing); }, counters, failures); });
  } catch (const std::runtime_error&) {
    report.rethrow();
    throw;
  }
  const std::string trouble = trouble_text({}, counters);
  if (!trouble.empty()) {
    raise_numerical_error("compression: " + trouble + "; its result is worthless", counters, failures, std::nullopt);
  }
  return system;
}

BodySystem random_start(nb::handle components, nb::handle number, nb::handle packing_fraction, nb::handle seed,
                        nb::handle nematic_order, nb::handle most_compressed, nb::handle progress) {
  ed::StartOptions options;
  options.seed = seed_of(seed, "seed");
  options.packing_fraction = python::number(packing_fraction, "packing_fraction");
  options.nematic_order = optional_number(nematic_order, "nematic_order");
  options.most_compressed =
      static_cast<int>(integer(most_compressed, "most_compressed", 2, std::numeric_limits<int>::max()));
  const std::vector<ComponentGroup> groups = components_of(components, number, options.seed);
  const std::vector<ed::Component> list = component_list(groups);
  options.groups = numbers_of(groups);
  return {compress(progress,
                   [&](auto report, ed::Counters& counters, std::vector<ed::FailedPair>& failures) {
                     options.progress = report;
                     options.counters = &counters;
                     options.failures = &failures;
                     return ed::random_start(list, options);
                   }),
          options.groups};
}

BodySystem compressed(nb::handle system, nb::handle packing_fraction, nb::handle progress) {
  const auto& bodies = instance<BodySystem>(system, "system");
  const double target = number(packing_fraction, "packing_fraction");
  return {compress(progress,
                   [&](auto report, ed::Counters& counters, std::vector<ed::FailedPair>& failures) {
                     return ed::compressed(bodies.system, target, report, &counters, &failures, bodies.groups);
                   }),
          bodies.groups};
}

/// Number of bodies of a face-centred cubic lattice if none is given: 5 x 5 x 5 cells, which bodies as long as wide
/// fill.
constexpr int kDefaultFccNumber = 500;

BodySystem lattice_start(nb::handle components, nb::handle number, nb::handle packing_fraction, nb::handle lattice,
                         nb::handle seed, nb::handle axis, nb::handle nematic_order) {
  ed::LatticeOptions options;
  options.seed = seed_of(seed, "seed");
  options.packing_fraction = python::number(packing_fraction, "packing_fraction");
  options.lattice = choice(lattice, "lattice", kLattices);
  if (!axis.is_none()) options.axis = static_cast<int>(integer(axis, "axis", 0, 2));
  const int usual_number = options.lattice == ed::Lattice::fcc ? kDefaultFccNumber : kDefaultNumber;
  options.nematic_order = optional_number(nematic_order, "nematic_order");
  const std::vector<ComponentGroup> groups = components_of(components, number, options.seed, usual_number);
  const std::vector<ed::Component> list = component_list(groups);
  options.groups = numbers_of(groups);
  options.poll = InterruptPoll();
  check_interrupts();
  return {unlocked([&] { return ed::lattice_start(list, options); }), options.groups};
}

#define HARDBODY_COMPONENTS "components: hardbody.Components, number: int | None = None, *, "

constexpr const char* kComponentsDoc =
    "components: a Species or a shape, of which there are `number`; a Polydisperse; or a list of (species or shape,\n"
    "number) and Polydisperse, whose bodies follow each other and are a group each. number: default 512, on an fcc\n"
    "lattice 500.\n";

void bind_random_start(nb::module_& module) {
  static const std::string doc =
      std::string(
          "Makes a start from random positions, orientations and velocities, by the paper's compression: dynamics\n"
          "alternates with shrinking the box. No two bodies overlap at any moment.\n\n") +
      kComponentsDoc +
      "packing_fraction: volume of the bodies over that of the box. seed: integer from 0 to 2^63 - 1; the same\n"
      "arguments give the same bits, those of the program. nematic_order: order parameter of the orientations as the\n"
      "bodies are placed; compression lets it relax. most_compressed: largest number of bodies that are compressed\n"
      "together; larger systems are built of copies of a smaller box. progress: a function that is given the packing\n"
      "fraction reached about ten times a second, and ends the start by returning False.\n"
      "\n"
      "Velocities: total momentum 0, kT = 1 exactly, each group by itself. The GIL is released.\n"
      "\n"
      "Raises ValueError for a packing fraction that no compression reaches (0.02 below random close packing) or too\n"
      "few bodies for the box; RuntimeError if the compression gets stuck; NumericalError if bodies overlapped.";
  module.def("random_start", &random_start, nb::arg("components").none(), nb::arg("number") = nb::none(), nb::kw_only(),
             nb::arg("packing_fraction").none(), nb::arg("seed").none() = 1, nb::arg("nematic_order") = nb::none(),
             nb::arg("most_compressed").none() = 1000, nb::arg("progress") = nb::none(),
             nb::sig("def random_start(" HARDBODY_COMPONENTS
                     "packing_fraction: float, seed: int = 1, nematic_order: float | None = None, "
                     "most_compressed: int = 1000, progress: collections.abc.Callable[[float], object] | None = None) "
                     "-> System"),
             doc.c_str());
}

void bind_compressed(nb::module_& module) {
  module.def(
      "compressed", &compressed, nb::arg("system").none(), nb::arg("packing_fraction").none(), nb::kw_only(),
      nb::arg("progress") = nb::none(),
      nb::sig("def compressed(system: System, packing_fraction: float, *, "
              "progress: collections.abc.Callable[[float], object] | None = None) -> System"),
      "Compresses a state to a higher packing fraction by the paper's method, from one state point to the next.\n"
      "Velocities are rescaled at the end as those of random_start, whose `progress` and errors it has.");
}

void bind_lattice_start(nb::module_& module) {
  static const std::string doc =
      std::string(
          "Places bodies on a lattice that fills the box, at exactly this packing fraction: dense and ordered states\n"
          "that no compression reaches. Velocities are as in random_start.\n\n") +
      kComponentsDoc +
      "lattice: 'fcc', 4 bodies a cell, or 'cubic', 1; cells are stretched to the proportions of the bodies. axis:\n"
      "body axis (0, 1, 2) along the box's z; None: that of revolution or body z. nematic_order: order parameter of\n"
      "that axis, to which the bodies are rotated without overlap; None: all are aligned.\n"
      "\n"
      "Raises ValueError where bodies would overlap, for a number that does not fill the lattice and for an order "
      "that\n"
      "bodies have no room for; the message names numbers that fit.";
  module.def("lattice_start", &lattice_start, nb::arg("components").none(), nb::arg("number") = nb::none(),
             nb::kw_only(), nb::arg("packing_fraction").none(), nb::arg("lattice").none() = "fcc",
             nb::arg("seed").none() = 1, nb::arg("axis") = nb::none(), nb::arg("nematic_order") = nb::none(),
             nb::sig("def lattice_start(" HARDBODY_COMPONENTS
                     "packing_fraction: float, lattice: typing.Literal['fcc', 'cubic'] = 'fcc', seed: int = 1, "
                     "axis: int | None = None, nematic_order: float | None = None) -> System"),
             doc.c_str());
}

}  // namespace

void bind_starts(nb::module_& module) {
  bind_random_start(module);
  bind_compressed(module);
  bind_lattice_start(module);
  bind_files(module);
}

}  // namespace hardbody::python
