/// Kernel of linked cells with AVX-512 F, VL, DQ and BW.

#define HARDBODY_CELL_KERNEL cell_kernel_avx512
#include "cells/kernels-inl.h"
