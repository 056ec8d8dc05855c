/// The kernels of ellipsoids of revolution. With AVX-512 F, VL, DQ and BW.

#define HARDBODY_UNIAXIAL_KERNELS uniaxial_kernels_avx512
#include "vectors/kernels-inl.h"
