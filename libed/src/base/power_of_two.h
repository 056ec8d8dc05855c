#pragma once

#include <cmath>

namespace ed::internal {

/// Returns the power of two whose logarithm is nearest to that of x > 0.
inline double nearest_power_of_two(double x) {
  return std::ldexp(1.0, static_cast<int>(std::lround(std::log2(x))));
}

}  // namespace ed::internal
