#define HARDBODY_BATCH_ROOTS roots_avx2

#include "unit/geom/batch/batch_roots-inl.h"
