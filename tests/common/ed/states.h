#pragma once

/// Fluids of hard ellipsoids of revolution for the tests of the event loop: fixed seeds, the program's units (semi-axes
/// with a b^2 = 1, kT = m = 1).

#include <ed/ed.h>

#include <geom/ellipsoid.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace ed_test {

/// Returns an ellipsoid with semi-axes along body x, y, z, a along z and X0 = a / b.
inline geom::Ellipsoid spheroid(double aspect_ratio) {
  const double b = 1 / std::cbrt(aspect_ratio);
  return geom::Ellipsoid({b, b, aspect_ratio * b});
}

enum class Inertia { paper, uniform };

inline const char* name_of(Inertia inertia) {
  return inertia == Inertia::paper ? "paper" : "uniform";
}

struct State {
  double aspect_ratio = 3;
  double packing_fraction = 0.40;
  int number = 512;
  Inertia inertia = Inertia::paper;
  std::uint64_t seed = 1;
};

inline std::string describe(const State& state) {
  return "X0 = " + std::to_string(state.aspect_ratio) + ", phi = " + std::to_string(state.packing_fraction) +
         ", N = " + std::to_string(state.number) + ", " + name_of(state.inertia) + " inertia, seed " +
         std::to_string(state.seed);
}

inline ed::Species species(double aspect_ratio, Inertia inertia) {
  const geom::Ellipsoid shape = spheroid(aspect_ratio);
  return inertia == Inertia::paper ? ed::paper_species(shape) : ed::uniform_species(shape);
}

inline ed::System start(const State& state) {
  ed::StartOptions options;
  options.number = state.number;
  options.packing_fraction = state.packing_fraction;
  options.seed = state.seed;
  return ed::random_start(species(state.aspect_ratio, state.inertia), options);
}

/// Returns a state after `time` of dynamics, its temperatures reset to exactly 1.
inline ed::System equilibrated(const State& state, double time) {
  ed::Simulation simulation(start(state));
  simulation.tune_envelopes();
  // Tuning ends with a collision, while two bodies touch; a moment later they are apart.
  simulation.run_until(std::max(time, simulation.time() + 0.01));
  ed::System system = simulation.system();
  ed::rescale_velocities(system);
  return system;
}

/// Returns the shape of all bodies of a system of one species.
inline const geom::Ellipsoid& ellipsoid_of(const ed::System& system) {
  return std::get<geom::Ellipsoid>(system.species.at(0).shape);
}

/// Returns bodies of an ideal gas: one in each cell of a cubic grid whose spacing is `spacing`, at rest.
inline ed::System grid(const ed::Species& kind, int along, double spacing) {
  ed::System system;
  system.species = {kind};
  system.box = along * spacing;
  for (int x = 0; x < along; ++x) {
    for (int y = 0; y < along; ++y) {
      for (int z = 0; z < along; ++z) {
        ed::Body body;
        body.position = spacing * Eigen::Vector3d(x, y, z);
        system.bodies.push_back(body);
      }
    }
  }
  return system;
}

}  // namespace ed_test
