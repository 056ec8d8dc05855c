#pragma once

namespace ed::internal {

/// The second Legendre polynomial, of the cosine between two axes.
inline double p2(double x) {
  return 1.5 * x * x - 0.5;
}

}  // namespace ed::internal
