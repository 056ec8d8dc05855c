#pragma once

#include <Eigen/Core>

namespace ed::internal {

/// A body found near a point, with the vector to its nearest image.
struct NearBody {
  int body;
  Eigen::Vector3d r;
};

}  // namespace ed::internal
