/// The kernel of sums of products of phases. With AVX-512 F, VL, DQ and BW.

#define HARDBODY_PRODUCT_KERNEL product_kernel_avx512
#include "vectors/products-inl.h"
