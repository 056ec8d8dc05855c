#pragma once

#include <geom/kernel/core.h>

namespace geom::kernel {

/// Returns volume and moments of a frustum with its ball.
SweptMass swept_frustum(const CoreView& core);

}  // namespace geom::kernel
