/// The kernel of rotations. With AVX-512 F, VL, DQ and BW.

#define HARDBODY_ROTATION_KERNEL rotation_kernel_avx512
#include "bodies/rotations-inl.h"
