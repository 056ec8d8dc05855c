#pragma once

#include <cmath>

namespace ed::internal {

/// Of a positive number: the power of two whose logarithm is nearest.
inline double nearest_power_of_two(double x) {
  return std::ldexp(1.0, static_cast<int>(std::lround(std::log2(x))));
}

}  // namespace ed::internal
