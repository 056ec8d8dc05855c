/// Kernel of linked cells for the instruction set of the whole library.

#define HARDBODY_CELL_KERNEL cell_kernel_portable
#include "cells/kernels-inl.h"
