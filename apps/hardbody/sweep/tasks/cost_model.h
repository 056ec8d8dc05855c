#pragma once

/// Expected cost of a run, by its config alone.

#include "config/config.h"

namespace hardbody {

/// Expected cost of a run.
struct Cost {
  double seconds;  ///< time of one processor
  double memory;   ///< bytes
};

/// Typical factor between the seconds of cost_by_config() and true ones, on a processor like the one that it was
/// measured on (docs/cluster.md).
inline constexpr double kCostModelFactor = 1.3;

/// Returns the cost of a run: collisions, by a fit of the collision rates of hard ellipsoids, and measurements, each
/// times its measured duration, and the start. Times "auto" are those of fluids of hard ellipsoids: what orders or
/// becomes a glass, or is of other shapes, may take several times as long.
Cost cost_by_config(const Config& config);

}  // namespace hardbody
