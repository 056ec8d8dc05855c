/// The kernel of sums of products of phases, four bodies at a time. Included by vectors/products_avx2.cpp and
/// products_avx512.cpp, which set HARDBODY_PRODUCT_KERNEL, the function's name (vectors/kernels-inl.h says why).

#include "base/highway-inl.h"
#include "vectors/products.h"

HWY_BEFORE_NAMESPACE();
namespace ed::internal {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using ProductTag = hn::CappedTag<double, 4>;
using PairTag = hn::CappedTag<double, 2>;
using ProductLanes = hn::Vec<ProductTag>;
using PairLanes = hn::Vec<PairTag>;
static_assert(hn::MaxLanes(ProductTag()) == 4 && hn::MaxLanes(PairTag()) == 2);

/// Adds two bodies at a time, so that sums have the bits of the portable kernel.
HWY_INLINE PairLanes plus(PairLanes sum, ProductLanes terms) {
  return hn::Add(hn::Add(sum, hn::LowerHalf(PairTag(), terms)), hn::UpperHalf(PairTag(), terms));
}

void add_products(const PhaseRows& rows, int bodies, ProductSums& sums) {
  const ProductTag d;
  const ProductLanes sign_x = hn::Set(d, rows.sign[0]);
  const ProductLanes sign_y = hn::Set(d, rows.sign[1]);
  const ProductLanes sign_z = hn::Set(d, rows.sign[2]);
  PairLanes re = hn::LoadU(PairTag(), sums.re);
  PairLanes im = hn::LoadU(PairTag(), sums.im);
  for (int i = 0; i < bodies; i += 4) {
    const ProductLanes xr = hn::LoadU(d, rows.re[0] + i), xi = hn::Mul(sign_x, hn::LoadU(d, rows.im[0] + i));
    const ProductLanes yr = hn::LoadU(d, rows.re[1] + i), yi = hn::Mul(sign_y, hn::LoadU(d, rows.im[1] + i));
    const ProductLanes zr = hn::LoadU(d, rows.re[2] + i), zi = hn::Mul(sign_z, hn::LoadU(d, rows.im[2] + i));
    const ProductLanes pr = hn::Sub(hn::Mul(xr, yr), hn::Mul(xi, yi));
    const ProductLanes pi = hn::Add(hn::Mul(xr, yi), hn::Mul(xi, yr));
    re = plus(re, hn::Sub(hn::Mul(pr, zr), hn::Mul(pi, zi)));
    im = plus(im, hn::Add(hn::Mul(pr, zi), hn::Mul(pi, zr)));
  }
  hn::StoreU(re, PairTag(), sums.re);
  hn::StoreU(im, PairTag(), sums.im);
}

}  // namespace

ProductKernel* HARDBODY_PRODUCT_KERNEL() {
  return add_products;
}

}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
