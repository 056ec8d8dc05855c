#pragma once

#include <geom/kernel/eigen_layout.h>

/// Marks what libhardbody_geom exports; everything else is hidden (built with -fvisibility=hidden).
#if defined(__GNUC__)
#define GEOM_EXPORT __attribute__((visibility("default")))
#else
#define GEOM_EXPORT
#endif
