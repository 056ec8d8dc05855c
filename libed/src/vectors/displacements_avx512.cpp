/// The kernel of displacements. With AVX-512 F, VL, DQ and BW.

#define HARDBODY_DISPLACEMENT_KERNEL displacement_kernel_avx512
#include "vectors/displacements-inl.h"
