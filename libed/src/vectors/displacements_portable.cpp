/// The kernel of displacements. What the whole library is compiled for.

#define HARDBODY_DISPLACEMENT_KERNEL displacement_kernel_portable
#include "vectors/displacements-inl.h"
