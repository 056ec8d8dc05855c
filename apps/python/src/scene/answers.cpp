#include "scene/answers.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <limits>

namespace hardbody::python {
namespace {

std::int64_t number_of(geom::BodyId body) {
  return static_cast<std::int64_t>(body);
}

void put_vector(const NewArray<double>& out, std::size_t row, const Eigen::Vector3d& v) {
  Eigen::Vector3d::Map(out.data + 3 * row) = v;
}

}  // namespace

nb::tuple arrays_of(const std::vector<geom::ScenePair>& pairs) {
  const std::size_t rows = pairs.size();
  const auto i = new_array<std::int64_t>({rows}), j = new_array<std::int64_t>({rows});
  const auto image = new_array<double>({rows, 3}), normal = new_array<double>({rows, 3});
  const auto point_a = new_array<double>({rows, 3}), point_b = new_array<double>({rows, 3});
  const auto distance = new_array<double>({rows}), error_bound = new_array<double>({rows});
  const auto residual = new_array<double>({rows});
  const auto iterations = new_array<std::int32_t>({rows});
  const auto status = new_array<std::uint8_t>({rows});
  for (std::size_t row = 0; row < rows; ++row) {
    const geom::ScenePair& pair = pairs[row];
    i.data[row] = number_of(pair.i);
    j.data[row] = number_of(pair.j);
    put_vector(image, row, pair.image);
    put_vector(normal, row, pair.result.normal);
    put_vector(point_a, row, pair.result.point_a);
    put_vector(point_b, row, pair.result.point_b);
    distance.data[row] = pair.result.distance;
    error_bound.data[row] = pair.result.error_bound;
    residual.data[row] = pair.result.residual;
    iterations.data[row] = pair.result.iterations;
    status.data[row] = static_cast<std::uint8_t>(pair.result.status);
  }
  return nb::make_tuple(i.array, j.array, image.array, distance.array, normal.array, point_a.array, point_b.array,
                        error_bound.array, residual.array, iterations.array, status.array);
}

nb::tuple arrays_of(const std::vector<geom::SceneOverlap>& pairs) {
  const std::size_t rows = pairs.size();
  const auto i = new_array<std::int64_t>({rows}), j = new_array<std::int64_t>({rows});
  const auto image = new_array<double>({rows, 3});
  const auto unknown = new_array<bool>({rows});
  for (std::size_t row = 0; row < rows; ++row) {
    i.data[row] = number_of(pairs[row].i);
    j.data[row] = number_of(pairs[row].j);
    put_vector(image, row, pairs[row].image);
    unknown.data[row] = pairs[row].answer == geom::Answer::unknown;
  }
  return nb::make_tuple(i.array, j.array, image.array, unknown.array);
}

nb::tuple arrays_of(const std::vector<geom::SceneImage>& bodies) {
  const ImageColumns columns(bodies.size());
  for (std::size_t row = 0; row < bodies.size(); ++row) columns.put(row, bodies[row]);
  return nb::make_tuple(columns.body.array, columns.image.array);
}

nb::object array_of(std::span<const geom::BodyId> bodies) {
  const auto out = new_array<std::int64_t>({bodies.size()});
  for (std::size_t row = 0; row < bodies.size(); ++row) out.data[row] = number_of(bodies[row]);
  return out.array;
}

nb::tuple place_of(const std::optional<geom::SceneImage>& body) {
  if (!body) return nb::make_tuple(nb::none(), nb::none());
  return nb::make_tuple(number_of(body->body), array_of(body->image));
}

void ImageColumns::put(std::size_t row, const std::optional<geom::SceneImage>& found) const {
  body.data[row] = found ? number_of(found->body) : -1;
  put_vector(image, row, found ? found->image : Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace hardbody::python
