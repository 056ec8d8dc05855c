#pragma once

/// Answers of scenes as NumPy arrays.

#include "base/arrays.h"

#include <geom/scene.h>

#include <nanobind/nanobind.h>

#include <optional>
#include <span>
#include <vector>

namespace hardbody::python {

/// Returns (i, j, image, distance, normal, point_a, point_b, error_bound, residual, iterations, status).
nb::tuple arrays_of(const std::vector<geom::ScenePair>& pairs);
/// Returns (i, j, image, unknown).
nb::tuple arrays_of(const std::vector<geom::SceneOverlap>& pairs);
/// Returns (body, image).
nb::tuple arrays_of(const std::vector<geom::SceneImage>& bodies);

/// Returns handles as an array.
nb::object array_of(std::span<const geom::BodyId> bodies);

/// Returns (handle, image), None for none.
nb::tuple place_of(const std::optional<geom::SceneImage>& body);

/// Columns of the body and image that each query of many has found; handle -1, image NaN: none.
struct ImageColumns {
  explicit ImageColumns(std::size_t rows)
      : body(new_array<std::int64_t>({rows})), image(new_array<double>({rows, 3})) {}
  void put(std::size_t row, const std::optional<geom::SceneImage>& found) const;

  NewArray<std::int64_t> body;
  NewArray<double> image;
};

}  // namespace hardbody::python
