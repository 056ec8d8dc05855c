#pragma once

namespace geom_test {

constexpr int kRootsAtOnce = 8;

/// Computes roots and inverses of eight numbers, by the formulas of the kernels for AVX-512, on a processor that has
/// it. Plain arrays are used because the file is compiled for such processors (batch/kernel.h states the consequences).
void roots_by_estimate(const double* x, double* root, double* inverse_root, double* near_inverse);

}  // namespace geom_test
