#pragma once

#include "base/arguments.h"

#include <geom/distance.h>

#include <array>

namespace hardbody::python {

/// Largest number of evaluations that may be asked for.
inline constexpr int kMostIterations = 1000000;

/// Returns the options of a distance that one pair and many pairs share; no start.
inline geom::DistanceOptions distance_options(nb::handle max_iterations, nb::handle penetration) {
  geom::DistanceOptions options;
  options.max_iterations = static_cast<int>(integer(max_iterations, "max_iterations", 1, kMostIterations));
  options.penetration =
      choice(penetration, "penetration", std::array{geom::Penetration::global, geom::Penetration::local});
  return options;
}

}  // namespace hardbody::python
