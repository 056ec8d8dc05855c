#pragma once

/// Exponential that gives the same bits on every processor, as sincos.h does for sine and cosine.

#include <bit>
#include <cstdint>

namespace ed::internal {

/// Returns e^x for |x| <= 700, to 2 units in the last place: x = k ln 2 + r with ln 2 in two parts (k times the first
/// is exact), |r| <= ln 2 / 2, and the power series of e^r to r^13 / 13! (the next term is below 5e-18).
inline double exponential(double x) {
  constexpr double kRound = 0x1.8p52;  // the last bit of this number is worth 1
  constexpr double kLn2High = 0x1.62e42fefa3800p-1;
  constexpr double kLn2Low = 5.497923018708371174712472e-14;
  const double shifted = x * 1.4426950408889634074 + kRound;
  const double k = shifted - kRound;
  const double r = (x - k * kLn2High) - k * kLn2Low;
  const double r2 = r * r;
  const double r4 = r2 * r2;
  const double low = (1.0 / 2 + r * (1.0 / 6)) + r2 * (1.0 / 24 + r * (1.0 / 120));
  const double middle = (1.0 / 720 + r * (1.0 / 5040)) + r2 * (1.0 / 40320 + r * (1.0 / 362880));
  const double high = (1.0 / 3628800 + r * (1.0 / 39916800)) + r2 * (1.0 / 479001600 + r * (1.0 / 6227020800));
  const double e_r = 1 + (r + r2 * (low + r4 * (middle + r4 * high)));
  const auto exponent = (std::bit_cast<std::uint64_t>(shifted) + 1023) << 52;
  return e_r * std::bit_cast<double>(exponent);
}

}  // namespace ed::internal
