/// The batch kernels. What the whole library is compiled for.

#define HARDBODY_BATCH_KERNELS batch_kernels_portable
#include "batch/kernel-inl.h"
