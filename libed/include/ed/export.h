#pragma once

#include <geom/kernel/eigen_layout.h>

/// Marks what libhardbody_ed exports; everything else is hidden (built with -fvisibility=hidden).
#if defined(__GNUC__)
#define ED_EXPORT __attribute__((visibility("default")))
#else
#define ED_EXPORT
#endif
