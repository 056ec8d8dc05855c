#pragma once

#include <Eigen/Core>

#include <cstddef>

namespace ed::internal {

/// Body found near a point, with the vector to its nearest image.
struct NearBody {
  int body;
  Eigen::Vector3d r;
};

// The kernels write this layout (cells/kernels.h).
static_assert(sizeof(NearBody) == 4 * sizeof(double) && offsetof(NearBody, r) == sizeof(double));

}  // namespace ed::internal
