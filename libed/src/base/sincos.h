#pragma once

/// Sine and cosine that give the same bits on every processor.
///
/// The C library selects variants with or without FMA at run time, which differ in the last bit: a trajectory would
/// depend on the machine. This one uses only +, -, * and is inlined; after square roots it is the largest part of the
/// finder's time. Argument reduction by Cody and Waite with pi/2 in three parts (33 + 33 + 53 bits), exact products for
/// |x| <= 2^20; polynomials of degree 13 and 14 on [-pi/4, pi/4] (the minimax coefficients of Cephes' sin.c). The error
/// is below 2 units in the last place of 1 against long double (tests/unit/ed/base/sincos_test.cpp); beyond the range
/// the C library's functions are used.

#include "base/archive.h"
#include "base/reduced_sincos.h"

#include <bit>
#include <cmath>
#include <cstdint>

namespace ed::internal {

struct SinCos {
  double sin;
  double cos;
};

template <class Archive, Is<SinCos> T>
void fields(Archive& archive, T& turned) {
  archive(turned.sin, turned.cos);
}

inline SinCos sincos(double x) {
  if (!(std::abs(x) <= kLargestAngle)) [[unlikely]]
    return {std::sin(x), std::cos(x)};
  const ReducedSinCos<double> reduced = reduced_sincos(x);
  const auto quadrant = std::bit_cast<std::uint64_t>(reduced.shifted);
  // The quadrant is selected by bit operations: branches on a random angle would be mispredicted half of the time.
  auto sin = std::bit_cast<std::uint64_t>(reduced.sin);
  auto cos = std::bit_cast<std::uint64_t>(reduced.cos);
  const std::uint64_t exchange = (sin ^ cos) & (std::uint64_t{0} - (quadrant & 1));
  sin ^= exchange ^ ((quadrant & 2) << 62);
  cos ^= exchange ^ (((quadrant + 1) & 2) << 62);
  return {std::bit_cast<double>(sin), std::bit_cast<double>(cos)};
}

}  // namespace ed::internal
