#pragma once

#include "shapes/format.h"

#include <geom/kernel/refuse.h>
#include <geom/tolerances.h>

#include <string>

namespace geom::kernel {

/// Throws std::invalid_argument unless a length is within [least, kMaxSemiAxis].
inline void check_length(const char* what, double x, double least) {
  if (x >= least && x <= kMaxSemiAxis) return;
  refuse(std::string(what) + " is " + shown(x) + "; accepted: " + shown(least) + " to " + shown(kMaxSemiAxis));
}

}  // namespace geom::kernel
