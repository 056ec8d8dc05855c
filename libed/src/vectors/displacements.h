#pragma once

/// Squares of displacements and the scattering functions of these, compiled once for each instruction set
/// (vectors/displacements-inl.h). Plain arrays only, as in vectors/kernels.h.

namespace ed::internal {

inline constexpr int kDisplacementsAtATime = 64;  ///< bodies of a call of the kernel

/// Sets squares[i] = r_i^2, r_i the distance of positions `to` and `from` of body i (x, y, z of each in turn), and
/// scattering[k * kDisplacementsAtATime + i] = sin(q_k r_i) / (q_k r_i) for each of `number` wave numbers q_k. That of
/// an angle q_k r_i which is 0 or above kLargestAngle is no number to be used.
using DisplacementKernel = void(const double* from, const double* to, const double* wave_numbers, int number,
                                double* squares, double* scattering);

DisplacementKernel* displacement_kernel_portable();
DisplacementKernel* displacement_kernel_avx2();
DisplacementKernel* displacement_kernel_avx512();

/// Returns the kernel of the fastest instruction set there is. All give the same bits.
DisplacementKernel* find_displacement_kernel();

}  // namespace ed::internal
