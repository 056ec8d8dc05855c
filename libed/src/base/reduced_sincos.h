#pragma once

/// Part of sincos.h that is the same formula for one number and for one in each lane of a vector. (Kernels for several
/// instruction sets must not include the headers that sincos.h includes.)

namespace ed::internal {

inline constexpr double kLargestAngle = 1048576.0;

/// Sine and cosine of x minus a multiple of pi/2; the lowest two bits of `shifted` are the number of that multiple
/// modulo 4.
template <class Real>
struct ReducedSinCos {
  Real shifted;
  Real sin;
  Real cos;
};

/// Returns the reduced sine and cosine for |x| <= kLargestAngle, of one number or of one in each lane of a vector.
template <class Real>
[[gnu::always_inline]] inline ReducedSinCos<Real> reduced_sincos(Real x) {
  // Adding 1.5 * 2^52 rounds to an integer, kept in the low bits.
  constexpr double kShift = 6755399441055744.0;
  const Real shifted = x * 0.63661977236758134308 + kShift;
  const Real k = shifted - kShift;
  Real r = x - k * 1.57079632673412561417;
  r -= k * 6.07710050630396597660e-11;
  r -= k * 2.02226624879595063154e-21;
  const Real z = r * r;
  const Real s = r + r * z *
                         (-1.66666666666666307295e-1 +
                          z * (8.33333333332211858878e-3 +
                               z * (-1.98412698295895385996e-4 +
                                    z * (2.75573136213857245213e-6 +
                                         z * (-2.50507477628578072866e-8 + z * 1.58962301576546568060e-10)))));
  const Real c = 1 - 0.5 * z +
                 z * z *
                     (4.16666666666665929218e-2 +
                      z * (-1.38888888888730564116e-3 +
                           z * (2.48015872888517045348e-5 +
                                z * (-2.75573141792967388112e-7 +
                                     z * (2.08757008419747316778e-9 + z * -1.13585365213876817300e-11)))));
  return {shifted, s, c};
}

}  // namespace ed::internal
