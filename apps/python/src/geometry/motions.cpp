#include "geometry/given/motions.h"
#include "base/arguments.h"
#include "base/arrays.h"
#include "base/gil.h"
#include "base/values.h"
#include "geometry/bind.h"
#include "geometry/contact_options.h"
#include "geometry/shapes.h"
#include "geometry/speeds.h"

#include <ed/contact_options.h>
#include <ed/motion.h>
#include <ed/time_of_contact.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <Eigen/Core>

#include <stdexcept>
#include <string>

namespace hardbody::python {
namespace {

using ed::ContactResult;
using ed::Motion;

Motion motion_of(nb::handle pose, nb::handle velocity, nb::handle angular_velocity, nb::handle inertia,
                 nb::handle time) {
  Motion motion;
  if (!pose.is_none()) motion.pose = instance<geom::Pose>(pose, "pose");
  if (!velocity.is_none()) motion.velocity = checked_speed(finite_vector3(velocity, "velocity"), "velocity");
  if (!angular_velocity.is_none()) {
    motion.angular_velocity = checked_speed(finite_vector3(angular_velocity, "angular_velocity"), "angular_velocity");
  }
  if (!inertia.is_none()) motion.inertia = finite_vector3(inertia, "inertia");
  motion.time = finite_number(time, "time");
  static_cast<void>(ed::propagate(motion, motion.time));  // refuses what is no motion
  return motion;
}

std::string motion_text(const Motion& m) {
  return "Motion(" + nb::cast<std::string>(nb::repr(nb::cast(m.pose))) + ", velocity=" + shown(m.velocity) +
         ", angular_velocity=" + shown(m.angular_velocity) + ", inertia=" + shown(m.inertia) +
         ", time=" + shown(m.time) + ')';
}

/// Returns the motion at another time. Throws ValueError, naming the time, if bodies are not in the world then.
Motion motion_at(const Motion& motion, nb::handle time) {
  const double until = finite_number(time, "time");
  try {
    return ed::propagate(motion, until);
  } catch (const std::invalid_argument& error) {
    throw nb::value_error(("time is " + shown(until) + ": " + error.what()).c_str());
  }
}

void bind_motion(nb::module_& module) {
  const auto array = [](const char* signature) { return nb::for_getter(nb::sig(signature)); };
  nb::class_<Motion> type(module, "Motion", nb::is_weak_referenceable(),
                          "Free motion of a rigid body, given by its state at one time.");
  type.def(
          "__init__",
          [](Motion* self, nb::handle pose, nb::handle velocity, nb::handle angular_velocity, nb::handle inertia,
             nb::handle time) { new (self) Motion(motion_of(pose, velocity, angular_velocity, inertia, time)); },
          nb::arg("pose") = nb::none(), nb::arg("velocity") = nb::none(), nb::arg("angular_velocity") = nb::none(),
          nb::arg("inertia") = nb::none(), nb::arg("time").none() = 0.0,
          nb::sig("def __init__(self, pose: Pose | None = None, velocity: numpy.typing.ArrayLike | None = None, "
                  "angular_velocity: numpy.typing.ArrayLike | None = None, "
                  "inertia: numpy.typing.ArrayLike | None = None, time: float = 0.0) -> None"),
          "Constructs a motion from its state at `time`: the pose (default the identity); the velocity of the centre\n"
          "of mass and the angular velocity, world frame, shape (3,) (default at rest); and the principal moments of\n"
          "inertia about body x, y, z, shape (3,) (default 1, 1, 1). Raises ValueError unless all numbers are finite,\n"
          "the moments positive and none larger than the sum of the other two, and the length of each velocity 0 or\n"
          "from 1e-50 to 1e50: squares of others overflow or underflow.")
      .def_prop_ro(
          "pose", [](const Motion& m) { return m.pose; }, "Pose at `time`.")
      .def_prop_ro(
          "velocity", [](const Motion& m) { return array_of(m.velocity); },
          array("def velocity(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Velocity of the centre of mass, world frame, shape (3,).")
      .def_prop_ro(
          "angular_velocity", [](const Motion& m) { return array_of(m.angular_velocity); },
          array("def angular_velocity(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Angular velocity, world frame, shape (3,).")
      .def_prop_ro(
          "inertia", [](const Motion& m) { return array_of(m.inertia); },
          array("def inertia(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Principal moments of inertia about body x, y, z, shape (3,).")
      .def_prop_ro(
          "time", [](const Motion& m) { return m.time; }, "Time of this state.")
      .def("at", &motion_at, nb::arg("time").none(), nb::sig("def at(self, time: float) -> Motion"),
           "Returns the same motion with its state at another time, before or after, by closed forms. The error is\n"
           "rounding, below 2e-15 (1 + |omega| |time - self.time|) radian.")
      .def("__repr__", &motion_text)
      .def(
          "__reduce__",
          [](nb::handle self) {
            const Motion& m = nb::cast<const Motion&>(self);
            return nb::make_tuple(self.type(),
                                  nb::make_tuple(m.pose, array_of(m.velocity), array_of(m.angular_velocity),
                                                 array_of(m.inertia), m.time));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
  bind_equality(type, [](const Motion& a, const Motion& b) {
    return same(a.pose, b.pose) && a.velocity == b.velocity && a.angular_velocity == b.angular_velocity &&
           a.inertia == b.inertia && a.time == b.time;
  });
}

void bind_contact_result(nb::module_& module) {
  const auto array = [](const char* signature) { return nb::for_getter(nb::sig(signature)); };
  nb::class_<ContactResult> type(module, "ContactResult", nb::is_weak_referenceable(), "Answer of time_of_contact.");
  type.def_prop_ro(
          "status", [](const ContactResult& r) { return to_string(r.status); },
          array("def status(self) -> typing.Literal['hit', 'separated', 'overlapping', 'budget_exhausted', 'failed']"),
          "Outcome. 'hit': the bodies touch at `time`, approaching, and not before. 'separated': no contact up to\n"
          "`time` = t_max. 'overlapping': the bodies overlap at `time`. 'budget_exhausted': max_evaluations are used\n"
          "up; `time` is a lower bound of the time of contact, from which the search may be continued. 'failed': no\n"
          "method can decide whether the bodies overlap at `time`.")
      .def_prop_ro(
          "time", [](const ContactResult& r) { return r.time; }, "Time of the outcome.")
      .def_prop_ro(
          "point", [](const ContactResult& r) { return array_of(r.point); },
          array("def point(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Contact point at `time`, world frame, shape (3,); NaN unless it is a hit.")
      .def_prop_ro(
          "normal", [](const ContactResult& r) { return array_of(r.normal); },
          array("def normal(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Unit normal from A to B, world frame, shape (3,); NaN unless it is a hit.")
      .def_prop_ro(
          "evaluations", [](const ContactResult& r) { return r.evaluations; },
          "Number of evaluations of the pair at points in time.")
      .def_prop_ro(
          "rescues", [](const ContactResult& r) { return r.rescues; },
          "Number of distances that 'newton8' or 'newton5' declined and the dual method answered.")
      .def("__repr__", [](const ContactResult& r) {
        return "ContactResult(status='" + std::string(to_string(r.status)) + "', time=" + shown(r.time) +
               ", point=" + shown(r.point) + ", normal=" + shown(r.normal) +
               ", evaluations=" + std::to_string(r.evaluations) + ')';
      });
  bind_value(type, &ContactResult::status, &ContactResult::time, &ContactResult::point, &ContactResult::normal,
             &ContactResult::evaluations, &ContactResult::rescues);
}

/// Throws ValueError for an option of given motions beside two Motions, where it would have no effect.
void refuse_beside_flights(const char* name, nb::handle value) {
  if (value.is_none()) return;
  throw nb::value_error(
      (std::string(name) + " is given, but both motions are a Motion; accepted: None, or a GivenMotion").c_str());
}

/// Throws ValueError for a method that searches on given motions do not have.
void refuse_method(nb::handle finder, nb::handle eps_d, nb::handle distance, nb::handle root) {
  const ed::ContactOptions options = contact_options(finder, nb::int_(1), eps_d, distance, root);
  if (options.finder == ed::Finder::certified) return;
  refuse_value("finder", "\"bracketing\"", "\"certified\" beside a GivenMotion");
}

ContactResult contact_of_given(const ed::BodyShape& a, nb::handle motion_a, const ed::BodyShape& b, nb::handle motion_b,
                               nb::handle t_min, nb::handle t_max, const ed::GivenContactOptions& options) {
  const ed::GivenMotion at_a = given_motion(motion_a, "motion_a"), at_b = given_motion(motion_b, "motion_b");
  const double from = t_min.is_none() ? 0 : finite_number(t_min, "t_min"), until = finite_number(t_max, "t_max");
  const GilReleased released;
  return ed::time_of_contact(a, at_a, b, at_b, from, until, options);
}

ContactResult contact(nb::handle a, nb::handle motion_a, nb::handle b, nb::handle motion_b, nb::handle t_max,
                      nb::handle finder, nb::handle max_evaluations, nb::handle eps_d, nb::handle distance,
                      nb::handle root, nb::handle t_min, nb::handle tolerance) {
  const ed::BodyShape shape_a = body_shape(a, "a"), shape_b = body_shape(b, "b");
  if (is_given_motion(motion_a) || is_given_motion(motion_b)) {
    refuse_method(finder, eps_d, distance, root);
    return contact_of_given(shape_a, motion_a, shape_b, motion_b, t_min, t_max,
                            given_options(max_evaluations, tolerance));
  }
  refuse_beside_flights("t_min", t_min);
  refuse_beside_flights("tolerance", tolerance);
  const Motion at_a = instance<Motion>(motion_a, "motion_a"), at_b = instance<Motion>(motion_b, "motion_b");
  const double until = number(t_max, "t_max");
  const ed::ContactOptions options = contact_options(
      finder, max_evaluations.is_none() ? nb::int_(2000) : nb::borrow(max_evaluations), eps_d, distance, root);
  const GilReleased released;
  return ed::time_of_contact(shape_a, at_a, shape_b, at_b, until, options);
}

void bind_time_of_contact(nb::module_& module) {
  module.def(
      "time_of_contact", &contact, nb::arg("a").none(), nb::arg("motion_a").none(), nb::arg("b").none(),
      nb::arg("motion_b").none(), nb::arg("t_max").none(), nb::kw_only(), nb::arg("finder").none() = "certified",
      nb::arg("max_evaluations") = nb::none(), nb::arg("eps_d") = nb::none(), nb::arg("distance").none() = "dual",
      nb::arg("root") = nb::none(), nb::arg("t_min") = nb::none(), nb::arg("tolerance") = nb::none(),
      nb::sig("def time_of_contact(a: hardbody.BodyShape, motion_a: Motion | GivenMotion, b: hardbody.BodyShape, "
              "motion_b: Motion | GivenMotion, t_max: float, *, finder: typing.Literal['certified', 'bracketing'] = "
              "'certified', "
              "max_evaluations: int | None = None, eps_d: float | None = None, "
              "distance: typing.Literal['dual', 'newton8', 'newton5'] = 'dual', "
              "root: typing.Literal['newton', 'one_dimensional'] | None = None, t_min: float | None = None, "
              "tolerance: float | None = None) -> ContactResult"),
      "Returns the first time in [max of the motions' times, t_max] at which two freely moving bodies touch and\n"
      "approach; t_max may be infinite. The search is certified: it never steps over a contact, however grazing.\n"
      "Bodies are built-in shapes of any kind but HalfSpace, superellipsoids with exponents from 0.25 to 1.6, and "
      "shapes\n"
      "of your own.\n"
      "\n"
      "Motions may be a GivenMotion instead, of one body or both; a Motion beside is then one, too. The search is "
      "from\n"
      "t_min (None: 0) to a finite t_max, and certified by the bounds of the motions. It is a hit if the distance is "
      "at\n"
      "most `tolerance` (None: 1e-13) of the sum of the bounding radii and it is not certain that the bodies move\n"
      "apart. Superellipsoids may have any exponents, max_evaluations (None: 10000) counts poses, and a bound that is\n"
      "seen to be broken raises ValueError, in words.\n"
      "\n"
      "max_evaluations (None: 2000) limits the effort: at 0.3 to 2 microseconds each for ellipsoids of revolution, up "
      "to 50 for\n"
      "others. finder='bracketing' is the method of De Michele (2010) instead, without a certificate, to which eps_d\n"
      "(None: 1e-6), distance and root (None: 'newton') apply; beside 'certified' they are refused. eps_d is a "
      "length,\n"
      "below the smallest semi-axis: steps are at least as long as it "
      "takes\n"
      "the bodies to get nearer by eps_d, so that contacts shallower than about that can be missed. The GIL is "
      "released.\n"
      "\n"
      "Accuracy: at the time returned the distance is below 2e-15 of the size of the pair (distance of centres plus\n"
      "bounding radii) or the rounding error of the time itself, mostly also for bodies that are not of revolution. A\n"
      "head-on contact's time is accurate to that distance over the normal velocity, a grazing contact's to its "
      "square\n"
      "root. Normals and points of random contacts are mostly accurate to 1e-15 (radian, sizes), at worst to 1e-12. "
      "At\n"
      "sharp tips, of exponents near 1.6, normals 1e-3 radian apart may fit equally well; where faces meet, points "
      "do.\n"
      "\n"
      "Raises ValueError for t_max before the motions' times, exponents out of range, and bodies that are beyond "
      "1e100\n"
      "when the search begins.");
}

}  // namespace

void bind_motions(nb::module_& module) {
  bind_motion(module);
  bind_given_motion(module);
  bind_contact_result(module);
  bind_time_of_contact(module);
}

}  // namespace hardbody::python
