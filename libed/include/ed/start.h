#pragma once

#include <ed/export.h>
#include <ed/system.h>

#include <cstdint>
#include <functional>

namespace ed {

/// Which start is wanted.
struct StartOptions {
  int number = 512;
  double packing_fraction = 0.4;
  std::uint64_t seed = 1;
  /// Called now and then with the packing fraction reached; returns false to stop (the start then throws).
  std::function<bool(double packing_fraction)> progress;
};

/// The largest packing fraction that a start from a random dilute configuration is asked to reach: 0.02 below random
/// close packing, which is 0.64 for spheres and 0.70 for ellipsoids of revolution (Donev et al., Science 303 (2004)
/// 990) and where the compression takes for ever.
ED_EXPORT double densest_start(const geom::Ellipsoid& shape);

/// Random positions and orientations at a low packing fraction, random velocities, then the paper's compression:
/// dynamics alternates with shrinking the box by the largest factor that leaves no overlap. No two bodies overlap at
/// any moment.
///
/// Velocities: total momentum zero; translational kT = 1 on 3N - 3 degrees of freedom, rotational kT = 1 on 2N and, if
/// the species spins, spin kT = 1 on N, each rescaled separately (at the end too, so that nearly spherical bodies,
/// which hardly exchange energy, have the right temperatures).
///
/// Throws std::invalid_argument for a packing fraction that is not positive or above densest_start, or a number below
/// smallest_number; std::runtime_error if the compression gets stuck.
ED_EXPORT System random_start(const Species& species, const StartOptions& options);

/// Sets momentum zero and the temperatures as above.
ED_EXPORT void rescale_velocities(System& system);

}  // namespace ed
