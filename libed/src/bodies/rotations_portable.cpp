/// The kernel of rotations. What the whole library is compiled for.

#define HARDBODY_ROTATION_KERNEL rotation_kernel_portable
#include "bodies/rotations-inl.h"
