/// The kernels of ellipsoids of revolution. What the whole library is compiled for.

#define HARDBODY_UNIAXIAL_KERNELS uniaxial_kernels_portable
#include "vectors/kernels-inl.h"
