#pragma once

/// Sine and cosine that give the same bits on every processor.
///
/// The C library picks variants with or without FMA at run time, which differ in the last bit: a trajectory would
/// depend on the machine. This one uses only +, -, * and is inlined; it is also what the finder's time goes into after
/// square roots. Argument reduction by Cody and Waite with pi/2 in three parts (33 + 33 + 53 bits), exact products for
/// |x| <= 2^20; polynomials of degree 13 and 14 on [-pi/4, pi/4] (the minimax coefficients of Cephes' sin.c). Error
/// below 2 units in the last place of 1 against long double (tests/unit/sincos_test.cpp); beyond the range, the C
/// library's.

#include <bit>
#include <cmath>
#include <cstdint>

namespace ed::internal {

struct SinCos {
  double sin;
  double cos;
};

inline SinCos sincos(double x) {
  if (!(std::abs(x) <= 1048576.0)) [[unlikely]]
    return {std::sin(x), std::cos(x)};
  // Adding 1.5 * 2^52 rounds to an integer, kept in the low bits.
  constexpr double kShift = 6755399441055744.0;
  const double shifted = x * 0.63661977236758134308 + kShift;
  const double k = shifted - kShift;
  const auto quadrant = std::bit_cast<std::uint64_t>(shifted);
  double r = x - k * 1.57079632673412561417;
  r -= k * 6.07710050630396597660e-11;
  r -= k * 2.02226624879595063154e-21;
  const double z = r * r;
  const double s = r + r * z *
                           (-1.66666666666666307295e-1 +
                            z * (8.33333333332211858878e-3 +
                                 z * (-1.98412698295895385996e-4 +
                                      z * (2.75573136213857245213e-6 +
                                           z * (-2.50507477628578072866e-8 + z * 1.58962301576546568060e-10)))));
  const double c = 1 - 0.5 * z +
                   z * z *
                       (4.16666666666665929218e-2 +
                        z * (-1.38888888888730564116e-3 +
                             z * (2.48015872888517045348e-5 +
                                  z * (-2.75573141792967388112e-7 +
                                       z * (2.08757008419747316778e-9 + z * -1.13585365213876817300e-11)))));
  // Quadrant by bit operations: branches on a random angle would be mispredicted half of the time.
  auto sin = std::bit_cast<std::uint64_t>(s);
  auto cos = std::bit_cast<std::uint64_t>(c);
  const std::uint64_t exchange = (sin ^ cos) & (std::uint64_t{0} - (quadrant & 1));
  sin ^= exchange ^ ((quadrant & 2) << 62);
  cos ^= exchange ^ (((quadrant + 1) & 2) << 62);
  return {std::bit_cast<double>(sin), std::bit_cast<double>(cos)};
}

}  // namespace ed::internal
