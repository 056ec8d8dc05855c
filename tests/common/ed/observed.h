#pragma once

/// Runs with their observables, for the tests.

#include <common/ed/states.h>

#include <ed/ed.h>

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <vector>

namespace ed_test {

/// Runs a simulation of `system` over the duration of the options; `look` is called after each measurement.
inline ed::Results observed(const ed::System& system, const ed::ObservablesOptions& options,
                            const std::function<void(const ed::Simulation&)>& look = {}) {
  ed::Simulation simulation(system);
  ed::Observables observables(options);
  while (observables.next_time() <= options.duration) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
    if (look) look(simulation);
  }
  simulation.run_until(options.duration);
  return observables.results(simulation);
}

/// Returns options for bodies of revolution only.
inline ed::ObservablesOptions options_of(const ed::System& system, double duration, double longest_lag,
                                         const std::vector<double>& wave_numbers = {}) {
  ed::ObservablesOptions options{};
  options.number = system.size();
  options.duration = duration;
  options.longest_lag = longest_lag;
  options.wave_numbers = wave_numbers;
  return options;
}

/// Returns a gas of bodies that never collide: Maxwellian velocities and angular velocities at kT = 1, not rescaled,
/// because rescaling would fix the totals and narrow the distribution.
inline ed::System maxwellian_gas(const ed::Species& species, int along, double spacing, std::uint64_t seed) {
  ed::System system = grid(species, along, spacing);
  ed::Random random(seed);
  const Eigen::Vector3d thermal = species.inertia.cwiseSqrt().cwiseInverse();
  for (ed::Body& body : system.bodies) {
    body.rotation = random.rotation();
    body.velocity = random.normal3();
    Eigen::Vector3d omega = random.normal3().cwiseProduct(thermal);
    if (!species.spins) omega.z() = 0;
    body.angular_velocity = body.rotation * omega;
  }
  return system;
}

}  // namespace ed_test
