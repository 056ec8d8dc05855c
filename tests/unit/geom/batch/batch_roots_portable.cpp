#define HARDBODY_BATCH_ROOTS roots_portable

#include "unit/geom/batch/batch_roots-inl.h"
