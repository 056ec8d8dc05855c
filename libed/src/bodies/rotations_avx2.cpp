/// The kernel of rotations. With AVX2, FMA, BMI and BMI2.

#define HARDBODY_ROTATION_KERNEL rotation_kernel_avx2
#include "bodies/rotations-inl.h"
