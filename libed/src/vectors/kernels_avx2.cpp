/// The kernels of ellipsoids of revolution. With AVX2, FMA, BMI and BMI2.

#define HARDBODY_UNIAXIAL_KERNELS uniaxial_kernels_avx2
#include "vectors/kernels-inl.h"
