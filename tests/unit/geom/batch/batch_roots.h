#pragma once

namespace geom_test {

constexpr int kRootsAtOnce = 8;

/// Computes roots and inverses of eight numbers, by the formulas of the batch kernels for an instruction set that the
/// processor must have. Plain arrays are used because each is compiled for such processors (batch/kernel.h states the
/// consequences).
/// @{
void roots_portable(const double* x, double* root, double* inverse_root, double* near_inverse);
void roots_avx2(const double* x, double* root, double* inverse_root, double* near_inverse);
void roots_avx512(const double* x, double* root, double* inverse_root, double* near_inverse);
/// @}

}  // namespace geom_test
