/// The kernel of linked cells. What the whole library is compiled for.

#define HARDBODY_CELL_KERNEL cell_kernel_portable
#include "cells/kernels-inl.h"
