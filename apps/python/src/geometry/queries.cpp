#include "base/arguments.h"
#include "base/arrays.h"
#include "base/values.h"
#include "geometry/bind.h"
#include "geometry/custom_queries.h"
#include "geometry/half_space.h"
#include "geometry/options.h"

#include <geom/any_shape.h>
#include <geom/queries.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <Eigen/Core>

#include <optional>
#include <stdexcept>
#include <string>

namespace hardbody::python {
namespace {

using geom::ClosestPoint;
using geom::DistanceResult;
using geom::Pose;
using geom::RayHit;

const Pose& pose(nb::handle value, const char* name) {
  return instance<Pose>(value, name);
}

/// Defines an attribute that is a vector.
template <class Result>
void bind_vector(nb::class_<Result>& type, const char* name, Eigen::Vector3d Result::*member, const char* doc) {
  const std::string signature = std::string("def ") + name + "(self) -> numpy.typing.NDArray[numpy.float64]";
  type.def_prop_ro(
      name, [member](const Result& r) { return array_of(r.*member); }, nb::for_getter(nb::sig(signature.c_str())), doc);
}

constexpr const char* kDistanceStatus =
    "def status(self) -> typing.Literal['separated', 'overlapping', 'not_converged', 'singular']";

void bind_distance_result(nb::module_& module) {
  nb::class_<DistanceResult> type(
      module, "DistanceResult", nb::is_weak_referenceable(),
      "Answer of distance, world frame. Every number is NaN if `status` is 'not_converged' or 'singular'.\n"
      "\n"
      "point_b - point_a = distance * normal to rounding.");
  type.def_prop_ro(
          "status", [](const DistanceResult& r) { return to_string(r.status); },
          nb::for_getter(nb::sig(kDistanceStatus)),
          "'separated' (or touching; certain if distance > 0), 'overlapping' (certain if distance + error_bound < 0),\n"
          "'not_converged' or 'singular': no answer.")
      .def_prop_ro(
          "distance", [](const DistanceResult& r) { return r.distance; },
          "Signed distance; below 0: minus the length of the shortest translation that separates the bodies.")
      .def_prop_ro(
          "error_bound", [](const DistanceResult& r) { return r.error_bound; },
          "Certified: distance <= true distance <= distance + error_bound, apart from rounding (1e-15 of the size of\n"
          "the pair). Infinite where nothing is certified: deep overlaps with penetration='local'.")
      .def_prop_ro(
          "residual", [](const DistanceResult& r) { return r.residual; },
          "Deviation (length) of the points found, those on the surfaces, from being distance * normal apart.")
      .def_prop_ro(
          "iterations", [](const DistanceResult& r) { return r.iterations; }, "Number of evaluations.")
      .def("__repr__", [](const DistanceResult& r) {
        return "DistanceResult(status='" + std::string(to_string(r.status)) + "', distance=" + shown(r.distance) +
               ", normal=" + shown(r.normal) + ", point_a=" + shown(r.point_a) + ", point_b=" + shown(r.point_b) +
               ", error_bound=" + shown(r.error_bound) + ')';
      });
  bind_vector(type, "normal", &DistanceResult::normal, "Unit vector from A to B, shape (3,).");
  bind_vector(type, "point_a", &DistanceResult::point_a, "Closest point of A, shape (3,).");
  bind_vector(type, "point_b", &DistanceResult::point_b, "Closest point of B, shape (3,).");
  bind_value(type, &DistanceResult::distance, &DistanceResult::point_a, &DistanceResult::point_b,
             &DistanceResult::normal, &DistanceResult::status, &DistanceResult::iterations, &DistanceResult::residual,
             &DistanceResult::error_bound);
}

void bind_distance(nb::module_& module) {
  module.def(
      "distance",
      [](nb::handle a, nb::handle pose_a, nb::handle b, nb::handle pose_b, nb::handle start, nb::handle max_iterations,
         nb::handle penetration) {
        geom::DistanceOptions options = distance_options(max_iterations, penetration);
        if (!start.is_none()) options.start = finite_vector3(start, "start");
        const geom::Pose& X_WA = pose(pose_a, "pose_a");
        const geom::Pose& X_WB = pose(pose_b, "pose_b");
        if (const auto found = half_space_distance(a, X_WA, b, X_WB)) return *found;
        return any::distance(query_shape(a, "a"), X_WA, query_shape(b, "b"), X_WB, options);
      },
      nb::arg("a").none(), nb::arg("pose_a").none(), nb::arg("b").none(), nb::arg("pose_b").none(), nb::kw_only(),
      nb::arg("start") = nb::none(), nb::arg("max_iterations").none() = geom::kMaxIterations,
      nb::arg("penetration").none() = "global",
      nb::sig("def distance(a: hardbody.AnyBody, pose_a: Pose, b: hardbody.AnyBody, pose_b: Pose, "
              "*, start: numpy.typing.ArrayLike | None = None, max_iterations: int = 60, "
              "penetration: typing.Literal['global', 'local'] = 'global') -> DistanceResult"),
      "Returns the signed distance of two bodies, with closest points, normal and a certified error bound.\n"
      "\n"
      "start: a guess of the normal from A to B, finite, shape (3,), for instance the last answer's; 0: none.\n"
      "max_iterations: maximum number of evaluations from each start, at least 1. penetration: 'global', the\n"
      "shortest of all translations that separate overlapping bodies; 'local', the nearest stationary one, which is\n"
      "faster at large depths.\n"
      "\n"
      "Errors are relative to the size of the pair: the distance of centres plus both bounding radii. Ellipsoids:\n"
      "at most 1e-13, mostly 1e-16. Superellipsoids of aspect ratios up to 10: at most 1e-12 when apart; flatter and\n"
      "longer ones 1e-9, or there is no answer. Overlaps deeper than the smallest radii of curvature: no other way\n"
      "out is shorter by more than error_bound, mostly 1e-9, up to 1e-7 where faces meet, and more for long bodies\n"
      "that are nearly parallel. Spheres, capsules, boxes, polyhedra, cylinders, cones and rounded ones beside\n"
      "each other: at most 1e-13 apart and at any depth, but error_bound in overlaps of cylinders and cones, 1e-9,\n"
      "up to 1e-5 where their axes are parallel to 1e-9 to 1e-3 only; half-spaces beside any: rounding. Shapes of your "
      "own: as ellipsoids where they\n"
      "are smooth; where they have kinks (faces, edges) mostly 1e-16 too, and at most 1e-9 apart, or there is no\n"
      "answer.\n"
      "\n"
      "A query takes a fraction of a microsecond for ellipsoids, one to three for superellipsoids, 0.05 to 0.3\n"
      "milliseconds in deep overlaps, 20 to 50 milliseconds where axes of bodies of revolution are nearly but not "
      "quite\n"
      "parallel, or a superellipsoid is in the centre of a round body. distance_many answers many pairs, several times "
      "faster.");
  module.def(
      "distance_lower_bound",
      [](nb::handle a, nb::handle pose_a, nb::handle b, nb::handle pose_b, nb::handle n) {
        return any::distance_lower_bound(body_shape(a, "a"), pose(pose_a, "pose_a"), body_shape(b, "b"),
                                         pose(pose_b, "pose_b"), direction3(n, "n"));
      },
      nb::arg("a").none(), nb::arg("pose_a").none(), nb::arg("b").none(), nb::arg("pose_b").none(), nb::arg("n").none(),
      nb::sig("def distance_lower_bound(a: hardbody.BodyShape, pose_a: Pose, b: hardbody.BodyShape, "
              "pose_b: Pose, n: numpy.typing.ArrayLike) -> float"),
      "Returns a lower bound of the distance, certain for any direction n from A to B, world frame, shape (3,): the\n"
      "gap between the tangent planes across n, less its rounding error. Negative if the bodies overlap in that\n"
      "projection.");
}

/// Neither answer of a yes or no is certain.
class Undecided : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

bool overlap(nb::handle a, nb::handle pose_a, nb::handle b, nb::handle pose_b, nb::handle start) {
  const Eigen::Vector3d guess = start.is_none() ? Eigen::Vector3d::Zero() : finite_vector3(start, "start");
  const geom::Pose& X_WA = pose(pose_a, "pose_a");
  const geom::Pose& X_WB = pose(pose_b, "pose_b");
  if (const auto found = half_space_distance(a, X_WA, b, X_WB)) return found->distance <= 0;
  const geom::Answer answer = any::overlap(query_shape(a, "a"), X_WA, query_shape(b, "b"), X_WB, guess);
  if (answer != geom::Answer::unknown) return answer == geom::Answer::yes;
  throw Undecided("overlap: neither answer is certain, the bodies touch within the error bound; distance has bounds");
}

void bind_overlap(nb::module_& module) {
  nb::exception<Undecided>(module, "UndecidedError", PyExc_ArithmeticError).attr("__doc__") =
      "Raised by overlap, and by contains for shapes of your own, where neither answer is certain.";
  module.def(
      "overlap", &overlap, nb::arg("a").none(), nb::arg("pose_a").none(), nb::arg("b").none(), nb::arg("pose_b").none(),
      nb::kw_only(), nb::arg("start") = nb::none(),
      nb::sig("def overlap(a: hardbody.AnyBody, pose_a: Pose, b: hardbody.AnyBody, pose_b: Pose, "
              "*, start: numpy.typing.ArrayLike | None = None) -> bool"),
      "Returns whether two bodies overlap, usually after one evaluation; touching counts as overlap.\n"
      "\n"
      "start: a guess of the normal from A to B, finite, shape (3,); 0 or None: the line of centres.\n"
      "\n"
      "Raises UndecidedError if neither answer is certain: bodies that touch within the error bound, rare and only\n"
      "with flat or long superellipsoids.");
}

void bind_closest_point(nb::module_& module) {
  nb::class_<ClosestPoint> type(module, "ClosestPoint", nb::is_weak_referenceable(),
                                "Answer of closest_point, world frame. Every number is NaN if there is no answer.");
  type.def_prop_ro(
          "status", [](const ClosestPoint& r) { return to_string(r.status); }, nb::for_getter(nb::sig(kDistanceStatus)),
          "'separated': the given point is outside; 'overlapping': inside; 'not_converged', 'singular': no answer.")
      .def_prop_ro(
          "distance", [](const ClosestPoint& r) { return r.distance; },
          "Signed distance; below 0: the given point is inside, at this depth.")
      .def_prop_ro(
          "error_bound", [](const ClosestPoint& r) { return r.error_bound; },
          "Certified: distance <= true distance <= distance + error_bound, apart from rounding.")
      .def("__repr__", [](const ClosestPoint& r) {
        return "ClosestPoint(status='" + std::string(to_string(r.status)) + "', distance=" + shown(r.distance) +
               ", point=" + shown(r.point) + ", normal=" + shown(r.normal) + ", error_bound=" + shown(r.error_bound) +
               ')';
      });
  bind_vector(type, "point", &ClosestPoint::point, "Closest point of the surface, shape (3,).");
  bind_vector(type, "normal", &ClosestPoint::normal,
              "Unit outward normal, shape (3,): the given point is point + distance * normal.");
  bind_value(type, &ClosestPoint::distance, &ClosestPoint::point, &ClosestPoint::normal, &ClosestPoint::status,
             &ClosestPoint::error_bound);
  module.def(
      "closest_point",
      [](nb::handle s, nb::handle X, nb::handle point) {
        if (const auto* floor = half_space(s)) {
          return geom::closest_point(*floor, pose(X, "pose"), finite_vector3(point, "point"));
        }
        return any::closest_point(query_shape(s, "shape"), pose(X, "pose"), finite_vector3(point, "point"));
      },
      nb::arg("shape").none(), nb::arg("pose").none(), nb::arg("point").none(),
      nb::sig("def closest_point(shape: hardbody.AnyBody, pose: Pose, point: numpy.typing.ArrayLike) "
              "-> ClosestPoint"),
      "Returns the point of a body's surface that is closest to a point, world frame, shape (3,), which may be "
      "inside.\n"
      "Accuracy and certificate are those of distance.");
}

void bind_contains(nb::module_& module) {
  module.def(
      "contains",
      [](nb::handle s, nb::handle X, nb::handle point) {
        if (const auto* floor = half_space(s)) {
          return geom::contains(*floor, pose(X, "pose"), finite_vector3(point, "point"));
        }
        const std::optional<bool> answer =
            any::contains(query_shape(s, "shape"), pose(X, "pose"), finite_vector3(point, "point"));
        if (answer) return *answer;
        throw Undecided("contains: the point is on the surface within the error bound; closest_point has bounds");
      },
      nb::arg("shape").none(), nb::arg("pose").none(), nb::arg("point").none(),
      nb::sig("def contains(shape: hardbody.AnyBody, pose: Pose, point: numpy.typing.ArrayLike) -> bool"),
      "Returns whether a point, world frame, shape (3,), is in the body or on its surface. Raises\n"
      "UndecidedError for shapes of your own where neither answer is certain.");
}

void bind_ray_cast(nb::module_& module) {
  nb::class_<RayHit> type(module, "RayHit", nb::is_weak_referenceable(),
                          "Answer of ray_cast, world frame. Numbers are NaN unless the ray meets.");
  type.def_prop_ro(
          "status", [](const RayHit& r) { return to_string(r.status); },
          nb::for_getter(nb::sig("def status(self) -> typing.Literal['hit', 'missed', 'inside', 'not_converged']")),
          "'hit': the ray meets the body at `t`; 'missed': certified; 'inside': the ray starts inside, t = 0;\n"
          "'not_converged': no answer.")
      .def_prop_ro(
          "t", [](const RayHit& r) { return r.t; }, "Ray parameter, in units of the direction's length.")
      .def("__repr__", [](const RayHit& r) {
        return "RayHit(status='" + std::string(to_string(r.status)) + "', t=" + shown(r.t) +
               ", point=" + shown(r.point) + ", normal=" + shown(r.normal) + ')';
      });
  bind_vector(type, "point", &RayHit::point, "First point of the ray in the body, shape (3,).");
  bind_vector(
      type, "normal", &RayHit::normal,
      "Unit outward normal there, shape (3,). For 'inside' it is that of the surface nearby or, in the centre,\n"
      "the direction against the ray.");
  bind_value(type, &RayHit::status, &RayHit::t, &RayHit::point, &RayHit::normal);
  module.def(
      "ray_cast",
      [](nb::handle s, nb::handle X, nb::handle origin, nb::handle direction) {
        if (const auto* floor = half_space(s)) {
          return geom::ray_cast(*floor, pose(X, "pose"), finite_vector3(origin, "origin"),
                                direction3(direction, "direction"));
        }
        return any::ray_cast(query_shape(s, "shape"), pose(X, "pose"), finite_vector3(origin, "origin"),
                             direction3(direction, "direction"));
      },
      nb::arg("shape").none(), nb::arg("pose").none(), nb::arg("origin").none(), nb::arg("direction").none(),
      nb::sig("def ray_cast(shape: hardbody.AnyBody, pose: Pose, origin: numpy.typing.ArrayLike, "
              "direction: numpy.typing.ArrayLike) -> RayHit"),
      "Returns the first point origin + t direction, t >= 0, in the body; both of shape (3,), world frame, the\n"
      "direction of any length but 0. The point is within 1e-13 of the bounding radius of the surface.");
}

}  // namespace

void bind_queries(nb::module_& module) {
  bind_distance_result(module);
  bind_distance(module);
  bind_overlap(module);
  bind_closest_point(module);
  bind_contains(module);
  bind_ray_cast(module);
}

}  // namespace hardbody::python
