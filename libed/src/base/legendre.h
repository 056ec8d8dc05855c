#pragma once

namespace ed::internal {

/// Returns the second Legendre polynomial of x, the cosine of the angle between two axes.
inline double p2(double x) {
  return 1.5 * x * x - 0.5;
}

}  // namespace ed::internal
