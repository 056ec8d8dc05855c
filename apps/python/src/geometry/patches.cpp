#include "base/arguments.h"
#include "base/arrays.h"
#include "base/parallel.h"
#include "geometry/bind.h"
#include "geometry/bodies.h"
#include "geometry/custom_queries.h"
#include "geometry/half_space.h"
#include "geometry/shapes.h"

#include <geom/any_convex.h>
#include <geom/contact_patch.h>

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <variant>
#include <vector>

namespace hardbody::python {
namespace {

using geom::ContactPatch;
using geom::Pose;

geom::PatchOptions patch_options(nb::handle within, nb::handle tolerance, nb::handle max_points) {
  constexpr long long kMostPoints = 1000000;
  geom::PatchOptions options;
  options.within = finite_number(within, "within");
  options.tolerance = finite_number(tolerance, "tolerance");
  options.max_points = static_cast<int>(integer(max_points, "max_points", 3, kMostPoints));
  return options;
}

/// Arrays of patches, the points of all of them in one.
nb::tuple arrays_of_patches(std::span<const ContactPatch> patches) {
  const std::size_t rows = patches.size();
  std::size_t points = 0;
  for (const ContactPatch& patch : patches) points += patch.points.size();
  const auto kind = new_array<std::uint8_t>({rows});
  const auto normal = new_array<double>({rows, 3}), centre = new_array<double>({rows, 3});
  const auto area = new_array<double>({rows}), error = new_array<double>({rows});
  const auto pair = new_array<std::int64_t>({points}), id = new_array<std::int64_t>({points});
  const auto point_a = new_array<double>({points, 3}), point_b = new_array<double>({points, 3});
  const auto depth = new_array<double>({points});
  std::size_t k = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    const ContactPatch& patch = patches[row];
    kind.data[row] = static_cast<std::uint8_t>(patch.kind);
    Eigen::Vector3d::Map(normal.data + 3 * row) = patch.normal;
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const bool none = patch.kind == geom::PatchKind::empty;
    Eigen::Vector3d::Map(centre.data + 3 * row) = none ? Eigen::Vector3d::Constant(kNone).eval() : patch.centre;
    area.data[row] = patch.area;
    error.data[row] = patch.error;
    for (const geom::PatchPoint& point : patch.points) {
      pair.data[k] = static_cast<std::int64_t>(row);
      id.data[k] = static_cast<std::int64_t>(point.id);
      Eigen::Vector3d::Map(point_a.data + 3 * k) = point.point_a;
      Eigen::Vector3d::Map(point_b.data + 3 * k) = point.point_b;
      depth.data[k++] = point.depth;
    }
  }
  return nb::make_tuple(kind.array, normal.array, area.array, centre.array, error.array, pair.array, point_a.array,
                        point_b.array, depth.array, id.array);
}

nb::tuple of_pair(nb::handle a, nb::handle pose_a, nb::handle b, nb::handle pose_b, nb::handle within,
                  nb::handle tolerance, nb::handle max_points) {
  const geom::PatchOptions options = patch_options(within, tolerance, max_points);
  const Pose& X_WA = instance<Pose>(pose_a, "pose_a");
  const Pose& X_WB = instance<Pose>(pose_b, "pose_b");
  const geom::DistanceResult at = [&] {
    if (const auto found = half_space_distance(a, X_WA, b, X_WB)) return *found;
    return any::distance(query_shape(a, "a"), X_WA, query_shape(b, "b"), X_WB, {});
  }();
  const ContactPatch patch =
      std::visit([&](const auto& s, const auto& t) { return geom::contact_patch(s, X_WA, t, X_WB, at, options); },
                 query_body(a, "a"), query_body(b, "b"));
  return nb::make_tuple(at, arrays_of_patches(std::span(&patch, 1)));
}

nb::tuple of_pairs(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle pairs, nb::handle within,
                   nb::handle shape_of, nb::handle threads, nb::handle tolerance, nb::handle max_points) {
  const geom::PatchOptions options = patch_options(within, tolerance, max_points);
  const PairQuery query(shapes, positions, quaternions, pairs, shape_of, threads, nb::none());
  std::vector<ContactPatch> patches(query.pairs.size());
  query.for_each([&](std::size_t row, std::size_t a, const Pose& X_WA, std::size_t b, const Pose& X_WB) {
    patches[row] = geom::contact_patch(query.bodies.shape(a), X_WA, query.bodies.shape(b), X_WB, options);
  });
  return arrays_of_patches(patches);
}

}  // namespace

void bind_patches(nb::module_& module) {
  const auto required = [](const char* name) { return nb::arg(name).none(); };
  module.def("contact_patch", &of_pair, required("a"), required("pose_a"), required("b"), required("pose_b"),
             required("within"), required("tolerance"), required("max_points"),
             nb::sig("def contact_patch(a: typing.Any, pose_a: Pose, b: typing.Any, pose_b: Pose, within: typing.Any, "
                     "tolerance: typing.Any, max_points: typing.Any) "
                     "-> tuple[DistanceResult, tuple[typing.Any, ...]]"));
  module.def("contact_patch_many", &of_pairs, required("shapes"), required("positions"), required("quaternions"),
             required("pairs"), required("within"), required("shape_of"), required("threads"), required("tolerance"),
             required("max_points"),
             nb::sig("def contact_patch_many(shapes: typing.Any, positions: typing.Any, quaternions: typing.Any, "
                     "pairs: typing.Any, within: typing.Any, shape_of: typing.Any, threads: typing.Any, "
                     "tolerance: typing.Any, max_points: typing.Any) -> tuple[typing.Any, ...]"));
}

}  // namespace hardbody::python
