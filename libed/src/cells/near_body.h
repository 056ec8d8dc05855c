#pragma once

#include <Eigen/Core>

#include <cstddef>

namespace ed::internal {

/// A body found near a point, with the vector to its nearest image.
struct NearBody {
  int body;
  Eigen::Vector3d r;
};

// As kernels write them (cell_kernels.h).
static_assert(sizeof(NearBody) == 4 * sizeof(double) && offsetof(NearBody, r) == sizeof(double));

}  // namespace ed::internal
