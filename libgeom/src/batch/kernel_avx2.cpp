/// Batch kernels with AVX2, FMA, BMI and BMI2.

#define HARDBODY_BATCH_KERNELS batch_kernels_avx2
#include "batch/kernel-inl.h"
