/// Batch kernels for the instruction set of the whole library.

#define HARDBODY_BATCH_KERNELS batch_kernels_portable
#include "batch/kernel-inl.h"
