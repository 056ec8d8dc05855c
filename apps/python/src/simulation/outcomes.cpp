#include "simulation/outcomes.h"

#include "base/arguments.h"
#include "base/arrays.h"
#include "base/values.h"
#include "geometry/shapes.h"
#include "simulation/bind.h"

#include <run/files/failure_file.h>

#include <ed/system.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>

namespace hardbody::python {
namespace {

using ed::Counters;
using ed::FailedPair;

/// Counter with its name and meaning.
struct Counter {
  const char* name;
  std::uint64_t Counters::*member;
  const char* doc;
};

constexpr std::array kCounters = {
    Counter{"collisions", &Counters::collisions, "Collisions."},
    Counter{"predictions", &Counters::predictions, "Contact searches started, refinements included."},
    Counter{"evaluations", &Counters::evaluations, "Evaluations of a pair at a point in time."},
    Counter{"kernel_calls", &Counters::kernel_calls, "Evaluations of the gap function along one normal."},
    Counter{"refinements", &Counters::refinements, "Evaluations that refine the lower bound of a contact's time."},
    Counter{"cold_restarts", &Counters::cold_restarts, "Warm starts that converged to a spurious maximum."},
    Counter{"rescues", &Counters::rescues, "Searches that needed a fallback."},
    Counter{"neighbour_rebuilds", &Counters::neighbour_rebuilds, "Envelopes renewed."},
    Counter{"envelope_checks", &Counters::envelope_checks, "Checks whether a body leaves its envelope."},
    Counter{"candidate_tests", &Counters::candidate_tests, "Pairs of envelopes tested in rebuilds."},
    Counter{"overlaps", &Counters::overlaps, "Overlaps met, deeper than 1e-12 of the pair's size: 0 in a sound run."},
    Counter{"declined", &Counters::declined,
            "Pairs for which no method could decide whether they overlap: 0 in a\n"
            "sound run."},
    Counter{"parting_contacts", &Counters::parting_contacts,
            "Contacts of bodies that did not approach: 0 in a sound\n"
            "run."},
    Counter{"unrecorded_failures", &Counters::unrecorded_failures, "Failed pairs beyond those in `failures`."},
};

nb::dict dictionary(const Counters& counters) {
  nb::dict made;
  for (const Counter& c : kCounters) made[c.name] = counters.*c.member;
  return made;
}

void bind_counters(nb::module_& module) {
  nb::class_<Counters> type(module, "Counters", nb::is_weak_referenceable(),
                            "Counters of a simulation's events since its construction.");
  for (const Counter& c : kCounters) {
    type.def_prop_ro(
        c.name, [member = c.member](const Counters& counters) { return counters.*member; },
        nb::for_getter(nb::sig((std::string("def ") + c.name + "(self) -> int").c_str())), c.doc);
  }
  type.def("asdict", &dictionary, nb::sig("def asdict(self) -> dict[str, int]"), "Returns all counters by their names.")
      .def("__repr__", [](const Counters& counters) {
        std::string text;
        for (const Counter& c : kCounters) {
          text += std::string(text.empty() ? "" : ", ") + c.name + '=' + std::to_string(counters.*c.member);
        }
        return "Counters(" + text + ')';
      });
  std::apply([&](const auto&... c) { bind_value(type, c.member...); }, kCounters);
}

void bind_kinetic(nb::module_& module) {
  using ed::KineticState;
  const auto array = [](const char* signature) { return nb::for_getter(nb::sig(signature)); };
  nb::class_<KineticState> type(module, "Kinetic", nb::is_weak_referenceable(),
                                "Kinetic energies of a state, and the temperatures that follow.");
  type.def_prop_ro(
          "energy", [](const KineticState& k) { return k.energy(); }, "Sum of the three energies.")
      .def_ro("translational_energy", &KineticState::translational_energy, "Energy of translation.")
      .def_ro("rotational_energy", &KineticState::rotational_energy,
              "Energy of rotation; of bodies of revolution only that across their axes.")
      .def_ro("spin_energy", &KineticState::spin_energy, "Energy of rotation of bodies of revolution about their axes.")
      .def_ro("translational_kT", &KineticState::translational_kT,
              "Temperature on 3N - 3 degrees of freedom, as momentum is zero.")
      .def_ro("rotational_kT", &KineticState::rotational_kT,
              "Temperature on 2 degrees of freedom of each body of revolution and 3 of each other.")
      .def_prop_ro(
          "axis_energy", [](const KineticState& k) { return array_of(k.axis_energy); },
          array("def axis_energy(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Energies of rotation about body x, y, z, shape (3,).")
      .def_prop_ro(
          "momentum", [](const KineticState& k) { return array_of(k.momentum); },
          array("def momentum(self) -> numpy.typing.NDArray[numpy.float64]"), "Total momentum, shape (3,).")
      .def("__repr__", [](const KineticState& k) {
        return "Kinetic(energy=" + shown(k.energy()) + ", translational_kT=" + shown(k.translational_kT) +
               ", rotational_kT=" + shown(k.rotational_kT) + ')';
      });
  using K = KineticState;
  bind_value(type, &K::translational_energy, &K::rotational_energy, &K::spin_energy, &K::translational_kT,
             &K::rotational_kT, &K::rotational_degrees_of_freedom, &K::spin_degrees_of_freedom, &K::axis_energy,
             &K::momentum);
}

void bind_audit(nb::module_& module) {
  using ed::Audit;
  nb::class_<Audit> type(
      module, "Audit", nb::is_weak_referenceable(),
      "Overlaps of all pairs of a state, in all images, and the smallest distance, computed from scratch.");
  type.def_ro("minimum_distance", &Audit::minimum_distance,
              "Smallest distance of all pairs, of nearest images unless the box is short, below 0 for an overlap;\n"
              "the box if no bodies are near each other.")
      .def_prop_ro(
          "closest_pair",
          [](const Audit& a) -> nb::object {
            if (a.closest_i < 0) return nb::none();
            return nb::make_tuple(a.closest_i, a.closest_j);
          },
          nb::for_getter(nb::sig("def closest_pair(self) -> tuple[int, int] | None")),
          "Bodies of that distance, twice the same for a body and an image of it; None if none are near each other.")
      .def_ro("overlaps", &Audit::overlaps, "Number of pairs that overlap by more than 1e-12 of their size.")
      .def_ro("unanswered", &Audit::unanswered, "Number of pairs whose distance has no answer.")
      .def_ro("finite", &Audit::finite, "Whether all numbers of the state are finite.")
      .def_ro("kinetic", &Audit::kinetic, "Kinetic energies.")
      .def_prop_ro(
          "sound", [](const Audit& a) { return a.overlaps == 0 && a.unanswered == 0 && a.finite; },
          "Whether there are no overlaps, no pairs without answer, and only finite numbers.")
      .def("__repr__", [](const Audit& a) {
        return "Audit(minimum_distance=" + shown(a.minimum_distance) + ", overlaps=" + std::to_string(a.overlaps) +
               ", unanswered=" + std::to_string(a.unanswered) + ", finite=" + (a.finite ? "True" : "False") + ')';
      });
  bind_value(type, &Audit::minimum_distance, &Audit::closest_i, &Audit::closest_j, &Audit::overlaps, &Audit::unanswered,
             &Audit::finite, &Audit::kinetic);
}

void bind_stall(nb::module_& module) {
  using ed::Stall;
  nb::class_<Stall> type(module, "Stall", nb::is_weak_referenceable(),
                         "Stall of a run: many events within almost no simulated time, so that it would never end.");
  type.def_ro("time", &Stall::time, "Simulated time.")
      .def_ro("events", &Stall::events, "Number of events.")
      .def_ro("span", &Stall::span, "Simulated time that these events have taken.")
      .def_prop_ro(
          "kind", [](const Stall& s) { return to_string(s.kind); }, "Kind of the most frequent event since.")
      .def_ro("i", &Stall::i, "Body of that event, or its first body.")
      .def_ro("j", &Stall::j, "Second body; -1 for an event of one body.")
      .def_ro("share", &Stall::share, "Fraction of that event among the events since.")
      .def("__repr__", [](const Stall& s) { return "Stall(" + ed::describe(s) + ')'; });
  bind_value(type, &Stall::time, &Stall::events, &Stall::span, &Stall::kind, &Stall::i, &Stall::j, &Stall::share);
}

std::string json_of(const FailedPair& pair) {
  for (const ed::BodyShape* shape : {&pair.shape_i, &pair.shape_j}) {
    if (std::holds_alternative<ed::CustomShape>(*shape)) {
      throw nb::type_error("a pair of shapes of your own has no JSON; accepted: pairs of built-in shapes");
    }
  }
  return failure_json({to_string(pair.reason), pair, {}});
}

/// Returns the call of a distance that gave no answer, as pickles have it.
nb::object distance_state(const std::optional<ed::FailedDistance>& call) {
  if (!call) return nb::none();
  const auto object = [](const geom::Shape& shape) {
    return std::visit([](const auto& s) { return nb::cast(s); }, shape);
  };
  return nb::make_tuple(to_state(call->method), to_state(call->status), object(call->shape_a), object(call->shape_b),
                        call->X_WA, call->X_WB, to_state(call->seed.point_a), to_state(call->seed.point_b),
                        to_state(call->seed.status));
}

std::optional<ed::FailedDistance> distance_of(nb::handle state) {
  if (state.is_none()) return std::nullopt;
  ed::FailedDistance call;
  from_state(state[0], call.method);
  from_state(state[1], call.status);
  call.shape_a = shape(state[2], "state");
  call.shape_b = shape(state[3], "state");
  from_state(state[4], call.X_WA);
  from_state(state[5], call.X_WB);
  from_state(state[6], call.seed.point_a);
  from_state(state[7], call.seed.point_b);
  from_state(state[8], call.seed.status);
  return call;
}

nb::tuple failed_state(const FailedPair& p) {
  return nb::make_tuple(to_state(p.reason), shape_object(p.shape_i), shape_object(p.shape_j), p.motion_i, p.motion_j,
                        p.time, p.i, p.j, to_state(p.finder), p.eps_d, distance_state(p.distance));
}

FailedPair failed_pair_of(const nb::tuple& state) {
  constexpr std::size_t kMembers = 11;
  if (state.size() != kMembers) {
    refuse_value("size of the state", std::to_string(state.size()), std::to_string(kMembers));
  }
  FailedPair pair;
  from_state(state[0], pair.reason);
  pair.shape_i = body_shape(state[1], "state");
  pair.shape_j = body_shape(state[2], "state");
  from_state(state[3], pair.motion_i);
  from_state(state[4], pair.motion_j);
  from_state(state[5], pair.time);
  from_state(state[6], pair.i);
  from_state(state[7], pair.j);
  from_state(state[8], pair.finder);
  from_state(state[9], pair.eps_d);
  pair.distance = distance_of(state[10]);
  return pair;
}

/// Defines pickling and == of failed pairs; pairs of shapes of the user's own can be pickled if these can.
void bind_failed_state(nb::class_<FailedPair>& type) {
  type.def("__getstate__", &failed_state, nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__",
          [](FailedPair& self, const nb::tuple& state) { new (&self) FailedPair(failed_pair_of(state)); },
          nb::sig("def __setstate__(self, state: tuple[typing.Any, ...], /) -> None"));
  bind_reduce(type);
  bind_equality(type, [](const FailedPair& a, const FailedPair& b) { return failed_state(a).equal(failed_state(b)); });
}

void bind_failed_pair(nb::module_& module) {
  const auto shape = [](const char* signature) { return nb::for_getter(nb::sig(signature)); };
  nb::class_<FailedPair> type(module, "FailedPair", nb::is_weak_referenceable(),
                              "Pair of bodies whose prediction failed, at that moment, with all that reproduces it.");
  type.def_prop_ro(
          "reason", [](const FailedPair& p) { return to_string(p.reason); }, "Reason in words.")
      .def_ro("time", &FailedPair::time, "Simulated time.")
      .def_ro("i", &FailedPair::i, "First body.")
      .def_ro("j", &FailedPair::j, "Second body.")
      .def_prop_ro(
          "shape_i", [](const FailedPair& p) { return shape_object(p.shape_i); },
          shape("def shape_i(self) -> hardbody.Shape | CustomShape"), "Shape of the first body.")
      .def_prop_ro(
          "shape_j", [](const FailedPair& p) { return shape_object(p.shape_j); },
          shape("def shape_j(self) -> hardbody.Shape | CustomShape"), "Shape of the second body.")
      .def_prop_ro(
          "motion_i", [](const FailedPair& p) { return p.motion_i; }, "Motion of the first body.")
      .def_prop_ro(
          "motion_j", [](const FailedPair& p) { return p.motion_j; },
          "Motion of the second body, in the image nearest to the first.")
      .def("to_json", &json_of, nb::sig("def to_json(self) -> str"),
           "Returns the pair as the file that `hardbody replay` reads.")
      .def("__repr__", [](const FailedPair& p) {
        return "FailedPair(bodies " + std::to_string(p.i) + " and " + std::to_string(p.j) + " at time " +
               shown(p.time) + ": " + to_string(p.reason) + ')';
      });
  bind_failed_state(type);
}

std::string times(std::uint64_t number) {
  return number == 1 ? "once" : std::to_string(number) + " times";
}

}  // namespace

std::string trouble_text(const Counters& before, const Counters& now) {
  std::string text;
  const auto add = [&](std::uint64_t Counters::*member, const char* what) {
    if (now.*member > before.*member) text += (text.empty() ? "" : "; ") + times(now.*member - before.*member) + what;
  };
  add(&Counters::overlaps, " two bodies overlapped");
  add(&Counters::declined, " no method could decide whether two bodies overlap");
  add(&Counters::parting_contacts, " bodies in contact did not approach");
  return text;
}

void raise_numerical_error(const std::string& message, const Counters& counters,
                           const std::vector<FailedPair>& failures, const std::optional<ed::Stall>& stall) {
  const nb::object type = nb::module_::import_("hardbody._errors").attr("NumericalError");
  const nb::object error = type(message, failures, counters, stall);
  PyErr_SetObject(type.ptr(), error.ptr());
  throw nb::python_error();
}

void bind_outcomes(nb::module_& module) {
  bind_counters(module);
  bind_kinetic(module);
  bind_audit(module);
  bind_stall(module);
  bind_failed_pair(module);
}

}  // namespace hardbody::python
