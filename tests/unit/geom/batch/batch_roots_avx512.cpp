#define HARDBODY_BATCH_ROOTS roots_avx512

#include "unit/geom/batch/batch_roots-inl.h"
