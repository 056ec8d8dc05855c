/// Kernel of linked cells with AVX2, FMA, BMI and BMI2.

#define HARDBODY_CELL_KERNEL cell_kernel_avx2
#include "cells/kernels-inl.h"
