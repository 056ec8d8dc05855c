#pragma once

namespace geom_test {

constexpr int kRootsAtOnce = 8;

/// Of eight numbers, by the formulas of the kernels for AVX-512, on a processor that has it: plain arrays, because the
/// file is compiled for such processors (batch_kernel.h says what follows from that).
void roots_by_estimate(const double* x, double* root, double* inverse_root, double* near_inverse);

}  // namespace geom_test
