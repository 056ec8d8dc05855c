#include "geometry/given/motions.h"

#include "base/arrays.h"
#include "base/gil.h"
#include "base/values.h"

#include <ed/motion.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace hardbody::python {
namespace {

using ed::GivenMotion;
using ed::MotionBounds;
using geom::Pose;

/// Python function that C++ calls, with or without the GIL, and may destroy.
class HeldFunction {
 public:
  explicit HeldFunction(nb::handle function) : function_(nb::borrow(function)) {}
  HeldFunction(const HeldFunction&) = delete;
  HeldFunction& operator=(const HeldFunction&) = delete;
  ~HeldFunction() {
    const GilAcquired gil;
    function_.reset();
  }

  template <class Read, class... Argument>
  auto call(const Read& read, Argument... arguments) const {
    const GilAcquired gil;
    return read(function_(arguments...));
  }

 private:
  nb::object function_;
};

MotionBounds bounds_of(nb::handle value) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  std::array<double, 4> numbers_of{kUnknown, kUnknown, kUnknown, kUnknown};
  constexpr const char* kBoundNumbers = "2 or 4 real numbers";
  const RealArray given(value, "bounds", kBoundNumbers);
  if (given.shape().size() != 1 || (given.shape()[0] != 2 && given.shape()[0] != 4)) {
    refuse_shape("bounds", given.shape(), kBoundNumbers);
  }
  std::copy_n(given.data(), given.shape()[0], numbers_of.begin());
  for (const double bound : numbers_of) {
    if (!(bound >= 0)) refuse_value("bounds", nb::cast<std::string>(nb::repr(value)), "numbers of 0 or more, or inf");
  }
  return {numbers_of[0], numbers_of[1], numbers_of[2], numbers_of[3]};
}

GivenMotion::PoseFunction pose_function(nb::handle pose) {
  if (PyCallable_Check(pose.ptr()) == 0) refuse_type("pose", pose, "a function of time that returns a Pose");
  const auto held = std::make_shared<const HeldFunction>(pose);
  return [held](double t) { return held->call([](nb::handle found) { return instance<Pose>(found, "pose(t)"); }, t); };
}

GivenMotion::BoundsFunction bounds_function(nb::handle bounds) {
  if (PyCallable_Check(bounds.ptr()) == 0) {
    const MotionBounds always = bounds_of(bounds);
    if (!std::isfinite(always.speed) || !std::isfinite(always.angular_speed)) {
      refuse_value("bounds", nb::cast<std::string>(nb::repr(bounds)), "finite speeds; accelerations may be inf");
    }
    return [always](double, double) { return always; };
  }
  const auto held = std::make_shared<const HeldFunction>(bounds);
  return [held](double from, double to) {
    return held->call([](nb::handle found) { return bounds_of(found); }, from, to);
  };
}

GivenMotion screw_of(nb::handle pose, nb::handle axis, nb::handle point, nb::handle angular_speed, nb::handle speed,
                     nb::handle time) {
  ed::Screw screw;
  screw.pose = instance<Pose>(pose, "pose");
  screw.axis = direction3(axis, "axis");
  screw.point = point.is_none() ? screw.pose.position() : finite_vector3(point, "point");
  screw.angular_speed = finite_number(angular_speed, "angular_speed");
  screw.speed = finite_number(speed, "speed");
  screw.time = finite_number(time, "time");
  return GivenMotion::screw(screw);
}

GivenMotion spline_of(nb::handle times, nb::handle poses) {
  const RealRows rows(times, "times", 1);
  std::vector<double> at;
  for (std::size_t k = 0; k < rows.size(); ++k) at.push_back(*rows[k]);
  if (!nb::isinstance<nb::sequence>(poses)) refuse_type("poses", poses, "a list of Pose");
  std::vector<Pose> through;
  for (const nb::handle pose : poses) {
    through.push_back(instance<Pose>(pose, ("poses[" + std::to_string(through.size()) + "]").c_str()));
  }
  return GivenMotion::spline(std::move(at), through);
}

nb::tuple tuple_of(const MotionBounds& b) {
  return nb::make_tuple(b.speed, b.angular_speed, b.acceleration, b.angular_acceleration);
}

}  // namespace

bool is_given_motion(nb::handle value) {
  return nb::isinstance<GivenMotion>(value);
}

GivenMotion given_motion(nb::handle value, const std::string& name) {
  if (is_given_motion(value)) return nb::cast<const GivenMotion&>(value);
  if (nb::isinstance<ed::Motion>(value)) return GivenMotion::flight(nb::cast<const ed::Motion&>(value));
  refuse_type(name, value, "Motion, GivenMotion");
}

ed::GivenContactOptions given_options(nb::handle max_evaluations, nb::handle tolerance) {
  ed::GivenContactOptions options;
  if (!max_evaluations.is_none()) {
    options.max_evaluations =
        static_cast<int>(integer(max_evaluations, "max_evaluations", 1, std::numeric_limits<int>::max()));
  }
  if (!tolerance.is_none()) options.tolerance = finite_number(tolerance, "tolerance");
  return options;
}

void bind_given_motion(nb::module_& module) {
  nb::class_<GivenMotion> type(
      module, "GivenMotion", nb::is_weak_referenceable(),
      "Motion of a rigid body as a function of time, with bounds of its speeds: for time_of_contact and\n"
      "Scene.first_contact. The static methods make the usual ones. It holds its functions; one that its own "
      "functions\n"
      "refer to is never freed.");
  refuse_pickling(type, "a GivenMotion", "its functions, or the numbers that it was made of");
  type.def(
          "__init__",
          [](GivenMotion* self, nb::handle pose, nb::handle bounds, nb::handle scales) {
            ed::MotionScales of;
            if (!scales.is_none()) {
              std::array<double, 2> both{};
              numbers(scales, "scales", both.data(), both.size());
              of = {both[0], both[1]};
            }
            new (self) GivenMotion(pose_function(pose), bounds_function(bounds), of);
          },
          nb::arg("pose").none(), nb::arg("bounds").none(), nb::arg("scales") = nb::none(),
          nb::sig("def __init__(self, pose: collections.abc.Callable[[float], Pose], "
                  "bounds: collections.abc.Sequence[float] | "
                  "collections.abc.Callable[[float, float], collections.abc.Sequence[float]], "
                  "scales: collections.abc.Sequence[float] | None = None) -> None"),
          "Constructs a motion from a function of time that returns a Pose, and bounds, for all time or as a function\n"
          "(from, to): (speed of the origin, angular speed) or (speed, angular speed, acceleration, angular\n"
          "acceleration), in radian and the units of lengths and times. Bounds of accelerations make searches "
          "quadratic\n"
          "in their convergence, and let bodies that touch move apart. Bounds that do not hold make searches miss\n"
          "contacts; check looks for such ones. scales: a length and a time (None: 0, 0) that the poses are computed\n"
          "from and whose rounding they have, of an axis far away or a clock that began long ago.")
      .def_static(
          "resting", [](nb::handle pose) { return GivenMotion::resting(instance<Pose>(pose, "pose")); },
          nb::arg("pose").none(), nb::sig("def resting(pose: Pose) -> GivenMotion"),
          "Returns the motion of a body at rest.")
      .def_static(
          "flight", [](nb::handle motion) { return GivenMotion::flight(instance<ed::Motion>(motion, "motion")); },
          nb::arg("motion").none(), nb::sig("def flight(motion: Motion) -> GivenMotion"),
          "Returns the free flight of a body.")
      .def_static(
          "screw", &screw_of, nb::arg("pose").none(), nb::arg("axis").none(), nb::arg("point") = nb::none(),
          nb::kw_only(), nb::arg("angular_speed").none() = 0.0, nb::arg("speed").none() = 0.0,
          nb::arg("time").none() = 0.0,
          nb::sig("def screw(pose: Pose, axis: numpy.typing.ArrayLike, point: numpy.typing.ArrayLike | None = None, *, "
                  "angular_speed: float = 0.0, speed: float = 0.0, time: float = 0.0) -> GivenMotion"),
          "Returns a uniform rotation about an axis and translation along it, world frame. pose: pose at `time`. "
          "axis:\n"
          "its direction, shape (3,), any length. point: a point of it (None: the pose's position). angular_speed:\n"
          "radian per time. speed: length per time.")
      .def_static(
          "spline", &spline_of, nb::arg("times").none(), nb::arg("poses").none(),
          nb::sig("def spline(times: numpy.typing.ArrayLike, poses: collections.abc.Sequence[Pose]) -> GivenMotion"),
          "Returns a motion through way points that starts and ends at rest: times, ascending, shape (N,), and N "
          "poses,\n"
          "N >= 2. Positions are cubic in time, quaternions too, scaled to length 1; velocities have no jumps.\n"
          "Rotations between way points are at most 120 degrees.")
      .def(
          "on", [](const GivenMotion& self, nb::handle parent) { return self.on(given_motion(parent, "parent")); },
          nb::arg("parent").none(), nb::sig("def on(self, parent: Motion | GivenMotion) -> GivenMotion"),
          "Returns this motion, given in the frame of a body that moves, seen from the world: of a joint on a link.")
      .def(
          "pose", [](const GivenMotion& self, nb::handle t) { return self.pose(finite_number(t, "t")); },
          nb::arg("t").none(), nb::sig("def pose(self, t: float) -> Pose"), "Returns the pose at a time.")
      .def(
          "bounds",
          [](const GivenMotion& self, nb::handle begin, nb::handle end) {
            return tuple_of(self.bounds(finite_number(begin, "begin"), finite_number(end, "end")));
          },
          nb::arg("begin").none(), nb::arg("end").none(),
          nb::sig("def bounds(self, begin: float, end: float) -> tuple[float, float, float, float]"),
          "Returns the bounds over an interval: speed, angular speed, acceleration, angular acceleration.")
      .def(
          "check",
          [](const GivenMotion& self, nb::handle begin, nb::handle end, nb::handle samples) {
            const double from = finite_number(begin, "begin"), to = finite_number(end, "end");
            if (to < from) refuse_value("end", shown(to), "a time not before begin, " + shown(from));
            return check_given_motion(self, from, to, static_cast<int>(integer(samples, "samples", 2, 100000000)));
          },
          nb::arg("begin").none(), nb::arg("end").none(), nb::arg("samples").none() = 1000,
          nb::sig("def check(self, begin: float, end: float, samples: int = 1000) -> str"),
          "Samples the motion and returns the first bound that it breaks, in words; empty if none, which is no proof.");
}

}  // namespace hardbody::python
