/// The kernel of sums of products of phases for the instruction set of the whole library, two bodies at a time.

#include "base/lanes.h"
#include "vectors/products.h"

namespace ed::internal {
namespace {

void add_products_of_two(const PhaseRows& rows, int bodies, ProductSums& sums) {
  Lanes re = both(sums.re);
  Lanes im = both(sums.im);
  for (int i = 0; i < bodies; i += 2) {
    const Lanes xr = both(rows.re[0] + i), xi = rows.sign[0] * both(rows.im[0] + i);
    const Lanes yr = both(rows.re[1] + i), yi = rows.sign[1] * both(rows.im[1] + i);
    const Lanes zr = both(rows.re[2] + i), zi = rows.sign[2] * both(rows.im[2] + i);
    const Lanes pr = xr * yr - xi * yi;
    const Lanes pi = xr * yi + xi * yr;
    re += pr * zr - pi * zi;
    im += pr * zi + pi * zr;
  }
  for (int k = 0; k < 2; ++k) {
    sums.re[k] = re[k];
    sums.im[k] = im[k];
  }
}

}  // namespace

ProductKernel* product_kernel_portable() {
  return add_products_of_two;
}

}  // namespace ed::internal
