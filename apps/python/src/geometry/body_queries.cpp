#include "base/arguments.h"
#include "base/arrays.h"
#include "base/parallel.h"
#include "geometry/bind.h"
#include "geometry/bodies.h"

#include <geom/queries.h>

#include <nanobind/nanobind.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <string>

namespace hardbody::python {
namespace {

/// Arguments that all queries about one body each share.
struct Query {
  Query(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle queries, const char* name,
        nb::handle of, nb::handle shape_of, nb::handle threads)
      : bodies(shapes, positions, quaternions, shape_of),
        rows(queries, name, 3),
        body_of(of, bodies, rows.size(), name),
        thread_number(thread_count(threads)) {}

  /// Calls answer(row, shape, pose) for all rows.
  template <class Answer>
  void run(Answer answer) const {
    parallel(rows.size(), range_length(rows.size(), thread_number), thread_number,
             Work([&](std::size_t begin, std::size_t end) {
               for (std::size_t row = begin; row < end; ++row) {
                 const std::size_t body = body_of[row];
                 answer(row, bodies.shape(body), bodies.pose(body));
               }
             }));
  }

  Bodies bodies;
  RealRows rows;
  BodyOf body_of;
  int thread_number;
};

nb::object contains_many(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle points,
                         nb::handle body_of, nb::handle shape_of, nb::handle threads) {
  const Query query(shapes, positions, quaternions, points, "points", body_of, shape_of, threads);
  const NewArray<bool> inside = new_array<bool>({query.rows.size()});
  query.run([&](std::size_t row, const geom::Shape& shape, const geom::Pose& pose) {
    inside.data[row] = geom::contains(shape, pose, query.rows.finite_vector(row));
  });
  return inside.array;
}

nb::tuple closest_point_many(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle points,
                             nb::handle body_of, nb::handle shape_of, nb::handle threads) {
  const Query query(shapes, positions, quaternions, points, "points", body_of, shape_of, threads);
  const std::size_t rows = query.rows.size();
  const NewArray<double> distance = new_array<double>({rows}), error_bound = new_array<double>({rows});
  const NewArray<double> point = new_array<double>({rows, 3}), normal = new_array<double>({rows, 3});
  const NewArray<std::uint8_t> status = new_array<std::uint8_t>({rows});
  query.run([&](std::size_t row, const geom::Shape& shape, const geom::Pose& pose) {
    const geom::ClosestPoint r = geom::closest_point(shape, pose, query.rows.finite_vector(row));
    distance.data[row] = r.distance;
    error_bound.data[row] = r.error_bound;
    Eigen::Vector3d::Map(point.data + 3 * row) = r.point;
    Eigen::Vector3d::Map(normal.data + 3 * row) = r.normal;
    status.data[row] = static_cast<std::uint8_t>(r.status);
  });
  return nb::make_tuple(distance.array, point.array, normal.array, error_bound.array, status.array);
}

nb::tuple ray_cast_many(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle origins,
                        nb::handle directions, nb::handle body_of, nb::handle shape_of, nb::handle threads) {
  const Query query(shapes, positions, quaternions, origins, "origins", body_of, shape_of, threads);
  const std::size_t rows = query.rows.size();
  const RealRows towards(directions, "directions", 3);
  check_rows("directions", towards.size(), "origins", rows);
  const NewArray<double> t = new_array<double>({rows});
  const NewArray<double> point = new_array<double>({rows, 3}), normal = new_array<double>({rows, 3});
  const NewArray<std::uint8_t> status = new_array<std::uint8_t>({rows});
  query.run([&](std::size_t row, const geom::Shape& shape, const geom::Pose& pose) {
    const Eigen::Vector3d direction = towards.finite_vector(row);
    if (direction.isZero(0)) refuse_value(entry("directions", row), "zero", "vectors other than 0");
    const geom::RayHit r = geom::ray_cast(shape, pose, query.rows.finite_vector(row), direction);
    t.data[row] = r.t;
    Eigen::Vector3d::Map(point.data + 3 * row) = r.point;
    Eigen::Vector3d::Map(normal.data + 3 * row) = r.normal;
    status.data[row] = static_cast<std::uint8_t>(r.status);
  });
  return nb::make_tuple(t.array, point.array, normal.array, status.array);
}

}  // namespace

void bind_body_queries(nb::module_& module) {
  const auto required = [](const char* name) { return nb::arg(name).none(); };
  constexpr const char* kPoints =
      "(shapes: typing.Any, positions: typing.Any, quaternions: typing.Any, points: typing.Any, "
      "body_of: typing.Any, shape_of: typing.Any, threads: typing.Any) -> ";
  const std::string contains = std::string("def contains_many") + kPoints + "numpy.typing.NDArray[numpy.bool]";
  const std::string closest = std::string("def closest_point_many") + kPoints + "tuple[typing.Any, ...]";
  module.def("contains_many", &contains_many, required("shapes"), required("positions"), required("quaternions"),
             required("points"), required("body_of"), required("shape_of"), required("threads"),
             nb::sig(contains.c_str()));
  module.def("closest_point_many", &closest_point_many, required("shapes"), required("positions"),
             required("quaternions"), required("points"), required("body_of"), required("shape_of"),
             required("threads"), nb::sig(closest.c_str()));
  module.def("ray_cast_many", &ray_cast_many, required("shapes"), required("positions"), required("quaternions"),
             required("origins"), required("directions"), required("body_of"), required("shape_of"),
             required("threads"),
             nb::sig("def ray_cast_many(shapes: typing.Any, positions: typing.Any, quaternions: typing.Any, "
                     "origins: typing.Any, directions: typing.Any, body_of: typing.Any, shape_of: typing.Any, "
                     "threads: typing.Any) -> tuple[typing.Any, ...]"));
}

}  // namespace hardbody::python
