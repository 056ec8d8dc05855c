#pragma once

/// Two numbers at a time: the vectors of every 64-bit processor. Both lanes have the bits that one number has.

#include "base/sincos.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace ed::internal {

using Lanes = double __attribute__((vector_size(16)));

/// Returns two numbers that follow each other.
inline Lanes both(const double* at) {
  return Lanes{at[0], at[1]};
}

inline double root(double x) {
  return std::sqrt(x);
}

inline Lanes root(Lanes x) {
  return Lanes{std::sqrt(x[0]), std::sqrt(x[1])};
}

struct SinCosLanes {
  Lanes sin;
  Lanes cos;
};

/// Returns sincos() of both lanes, for |x| <= kLargestAngle.
inline SinCosLanes sincos(Lanes x) {
  using Bits = std::uint64_t __attribute__((vector_size(16)));
  const ReducedSinCos<Lanes> reduced = reduced_sincos(x);
  const auto quadrant = std::bit_cast<Bits>(reduced.shifted);
  const auto sin = std::bit_cast<Bits>(reduced.sin);
  const auto cos = std::bit_cast<Bits>(reduced.cos);
  const Bits exchange = (sin ^ cos) & -(quadrant & 1);
  return {std::bit_cast<Lanes>(sin ^ exchange ^ ((quadrant & 2) << 62)),
          std::bit_cast<Lanes>(cos ^ exchange ^ (((quadrant + 1) & 2) << 62))};
}

}  // namespace ed::internal
