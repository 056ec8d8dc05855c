#pragma once

/// Bodies in free flight, whose correlations are known, and their observables.

#include <common/ed/states.h>

#include <ed/ed.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace ed_test {

/// Sums over some thousand terms of order 1, and positions of order 100 that differ by 1.
inline constexpr double kRounding = 1e-11;

/// 27 bodies on a grid, with random orientations, velocities and temperatures of exactly 1; 200 apart they do not meet.
inline ed::System free_bodies(double aspect_ratio, Inertia inertia, std::uint64_t seed, double spacing = 200) {
  ed::System system = grid(species(aspect_ratio, inertia), 3, spacing);
  ed::Random random(seed);
  for (ed::Body& body : system.bodies) {
    body.rotation = random.rotation();
    body.velocity = random.normal3();
    Eigen::Vector3d omega = random.normal3();
    if (!system.species[0].spins) omega.z() = 0;
    body.angular_velocity = body.rotation * omega;
  }
  ed::rescale_velocities(system);
  return system;
}

inline ed::Results measured(const ed::System& system, const ed::ObservablesOptions& options, double until) {
  ed::Simulation simulation(system);
  ed::Observables observables(options);
  double last = -1;
  while (observables.next_time() <= until) {
    EXPECT_GT(observables.next_time(), last);
    last = observables.next_time();
    simulation.run_until(last);
    observables.measure(simulation);
  }
  simulation.run_until(until);
  EXPECT_EQ(simulation.counters().collisions, 0U);
  return observables.results(simulation);
}

inline ed::Results of_run(const ed::System& system, double duration, double longest_lag,
                          const std::vector<ed::BodyGroup>& groups = {}) {
  ed::Simulation simulation(system);
  ed::Observables observables({system.size(), duration, longest_lag, groups});
  while (observables.next_time() <= duration) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
  }
  return observables.results(simulation);
}

}  // namespace ed_test
