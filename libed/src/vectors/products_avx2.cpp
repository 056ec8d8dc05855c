/// The kernel of sums of products of phases. With AVX2, FMA, BMI and BMI2.

#define HARDBODY_PRODUCT_KERNEL product_kernel_avx2
#include "vectors/products-inl.h"
