/// The kernel of displacements. With AVX2, FMA, BMI and BMI2.

#define HARDBODY_DISPLACEMENT_KERNEL displacement_kernel_avx2
#include "vectors/displacements-inl.h"
