#pragma once

#include <cmath>

namespace geom::kernel {

/// Returns the length of (x, y): std::hypot, which is slow, only where squares might leave the range of doubles.
inline double length_of(double x, double y) {
  const double square = x * x + y * y;
  return square > 1e-200 && square < 1e200 ? std::sqrt(square) : std::hypot(x, y);
}

}  // namespace geom::kernel
