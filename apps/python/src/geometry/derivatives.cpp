#include "base/arguments.h"
#include "base/arrays.h"
#include "base/parallel.h"
#include "geometry/bind.h"
#include "geometry/bodies.h"
#include "geometry/half_space.h"
#include "geometry/options.h"
#include "geometry/shapes.h"

#include <geom/any_shape.h>
#include <geom/derivatives.h>

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

namespace hardbody::python {
namespace {

using geom::DistanceDerivatives;
using geom::DistanceResult;
using geom::Pose;

geom::AnyConvex any_convex(const geom::Shape& shape) {
  return std::visit([](const auto& s) { return geom::AnyConvex(s); }, shape);
}
const geom::AnyConvex& any_convex(const geom::AnyConvex& shape) {
  return shape;
}
const geom::HalfSpace& any_convex(const geom::HalfSpace& shape) {
  return shape;
}

/// Returns the answer and its derivatives; not both bodies are half-spaces.
DistanceDerivatives derivatives(const QueryBody& a, const Pose& X_WA, const QueryBody& b, const Pose& X_WB,
                                const geom::DistanceOptions& options, DistanceResult& at) {
  return std::visit(
      [&](const auto& s, const auto& t) -> DistanceDerivatives {
        using S = std::decay_t<decltype(s)>;
        using T = std::decay_t<decltype(t)>;
        if constexpr (std::is_same_v<S, geom::HalfSpace> && std::is_same_v<T, geom::HalfSpace>) {
          return {};
        } else if constexpr (std::is_same_v<S, T>) {
          return geom::distance_derivatives(s, X_WA, t, X_WB, options, &at);
        } else if constexpr (std::is_same_v<S, geom::HalfSpace> || std::is_same_v<T, geom::HalfSpace>) {
          at = geom::distance(any_convex(s), X_WA, any_convex(t), X_WB);
          return geom::distance_derivatives(any_convex(s), X_WA, any_convex(t), X_WB, at);
        } else {
          return geom::distance_derivatives(any_convex(s), X_WA, any_convex(t), X_WB, options, &at);
        }
      },
      a, b);
}

/// Copies a matrix row by row.
template <class Matrix>
void put(const NewArray<double>& out, std::size_t row, const Matrix& matrix) {
  double* to = out.data + row * static_cast<std::size_t>(matrix.size());
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) *to++ = matrix(i, k);
  }
}

/// Arrays of derivatives. Without second ones, those arrays are empty.
struct DerivativeColumns {
  DerivativeColumns(std::size_t rows, bool with_second)
      : gradient(new_array<double>({rows, 12})),
        hessian(new_array<double>({with_second ? rows : 0, 12, 12})),
        normal(new_array<double>({with_second ? rows : 0, 3, 12})),
        point_a(new_array<double>({with_second ? rows : 0, 3, 12})),
        point_b(new_array<double>({with_second ? rows : 0, 3, 12})),
        stiffness(new_array<double>({rows})),
        status(new_array<std::uint8_t>({rows})),
        second(with_second) {}

  void put_row(std::size_t row, const DistanceDerivatives& d) const {
    put(gradient, row, d.gradient);
    stiffness.data[row] = d.stiffness;
    status.data[row] = static_cast<std::uint8_t>(d.status);
    if (!second) return;
    put(hessian, row, d.hessian);
    put(normal, row, d.normal);
    put(point_a, row, d.point_a);
    put(point_b, row, d.point_b);
  }

  nb::tuple arrays() const {
    const auto given = [this](const NewArray<double>& a) { return second ? a.array : nb::object(nb::none()); };
    return nb::make_tuple(gradient.array, given(hessian), given(normal), given(point_a), given(point_b),
                          stiffness.array, status.array);
  }

  NewArray<double> gradient, hessian, normal, point_a, point_b, stiffness;
  NewArray<std::uint8_t> status;
  bool second;
};

nb::tuple of_one_pair(nb::handle a, nb::handle pose_a, nb::handle b, nb::handle pose_b, nb::handle start,
                      nb::handle max_iterations, nb::handle penetration) {
  geom::DistanceOptions options = distance_options(max_iterations, penetration);
  if (!start.is_none()) options.start = finite_vector3(start, "start");
  refuse_two_half_spaces(a, b);
  const QueryBody s = query_body(a, "a"), t = query_body(b, "b");
  DistanceResult at;
  const DistanceDerivatives d =
      derivatives(s, instance<Pose>(pose_a, "pose_a"), t, instance<Pose>(pose_b, "pose_b"), options, at);
  const DerivativeColumns out(1, true);
  out.put_row(0, d);
  return nb::make_tuple(at, out.arrays());
}

/// Answers of distance_many for the same pairs.
struct Answers {
  explicit Answers(nb::handle columns)
      : distance(nb::handle(columns[0]), "distance", 1),
        normal(nb::handle(columns[1]), "normal", 3),
        point_a(nb::handle(columns[2]), "point_a", 3),
        point_b(nb::handle(columns[3]), "point_b", 3),
        error_bound(nb::handle(columns[4]), "error_bound", 1),
        status(nb::handle(columns[5]), "status", 1) {}

  DistanceResult row(std::size_t k) const {
    DistanceResult at;
    at.distance = *distance[k];
    at.normal = Eigen::Vector3d::Map(normal[k]);
    at.point_a = Eigen::Vector3d::Map(point_a[k]);
    at.point_b = Eigen::Vector3d::Map(point_b[k]);
    at.error_bound = *error_bound[k];
    at.status = static_cast<geom::DistanceStatus>(status.at(k, 0, 4));
    return at;
  }

  RealRows distance, normal, point_a, point_b, error_bound;
  IndexRows status;
};

nb::tuple of_many_pairs(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle pairs,
                        nb::handle shape_of, nb::handle threads, nb::handle answers, bool second) {
  const PairQuery query(shapes, positions, quaternions, pairs, shape_of, threads, nb::none());
  const Answers at(answers);
  check_rows("distance", at.distance.size(), "pairs", query.pairs.size());
  const DerivativeColumns out(query.pairs.size(), second);
  query.for_each([&](std::size_t row, std::size_t a, const Pose& X_WA, std::size_t b, const Pose& X_WB) {
    out.put_row(row, geom::distance_derivatives(query.bodies.shape(a), X_WA, query.bodies.shape(b), X_WB, at.row(row)));
  });
  return out.arrays();
}

}  // namespace

void bind_derivatives(nb::module_& module) {
  const auto required = [](const char* name) { return nb::arg(name).none(); };
  module.def("distance_derivatives", &of_one_pair, required("a"), required("pose_a"), required("b"), required("pose_b"),
             required("start"), required("max_iterations"), required("penetration"),
             nb::sig("def distance_derivatives(a: typing.Any, pose_a: Pose, b: typing.Any, pose_b: Pose, "
                     "start: typing.Any, max_iterations: typing.Any, penetration: typing.Any) "
                     "-> tuple[DistanceResult, tuple[typing.Any, ...]]"));
  module.def("distance_derivatives_many", &of_many_pairs, required("shapes"), required("positions"),
             required("quaternions"), required("pairs"), required("shape_of"), required("threads"), nb::arg("answers"),
             nb::arg("second"),
             nb::sig("def distance_derivatives_many(shapes: typing.Any, positions: typing.Any, "
                     "quaternions: typing.Any, pairs: typing.Any, shape_of: typing.Any, threads: typing.Any, "
                     "answers: tuple[typing.Any, ...], second: bool) -> tuple[typing.Any, ...]"));
}

}  // namespace hardbody::python
