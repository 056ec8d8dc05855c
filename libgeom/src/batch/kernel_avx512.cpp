/// Batch kernels with AVX-512 F, VL, DQ and BW.

#define HARDBODY_BATCH_KERNELS batch_kernels_avx512
#include "batch/kernel-inl.h"
