#pragma once

namespace ed::internal {

/// Constants of a rod: a capsule, or a sphere as a rod of no length.
struct Rod {
  double half_length = 0;  ///< half the distance of the centres of its caps
  double radius = 1;
};

}  // namespace ed::internal
