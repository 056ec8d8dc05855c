#pragma once

/// Highway, as all kernels include it, before anything else.

// Instructions that the kernels do not need are not required of the processor.
#define HWY_DISABLE_PCLMUL_AES
#define HWY_DISABLE_F16C
// Highway's checks would call its library.
#undef HWY_IS_DEBUG_BUILD
#define HWY_IS_DEBUG_BUILD 0

#include <hwy/highway.h>
