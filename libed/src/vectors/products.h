#pragma once

/// Sums of products of phases, compiled once for each instruction set (vectors/products-inl.h). Plain arrays only, as
/// in vectors/kernels.h.

namespace ed::internal {

/// exp(i k x), exp(i l y) and exp(i m z) of successive bodies: real and imaginary parts.
struct PhaseRows {
  const double* re[3];
  const double* im[3];
  double sign[3];  ///< 1, or -1 for the conjugate
};

/// Sums over bodies of even number, and of odd number.
struct ProductSums {
  double re[2];
  double im[2];
};

/// Adds the products of the first bodies' phases in their order. `bodies`: a multiple of four.
using ProductKernel = void(const PhaseRows& rows, int bodies, ProductSums& sums);

ProductKernel* product_kernel_portable();
ProductKernel* product_kernel_avx2();
ProductKernel* product_kernel_avx512();

/// Returns the kernel of the fastest instruction set there is. All give the same bits.
ProductKernel* find_product_kernel();

}  // namespace ed::internal
