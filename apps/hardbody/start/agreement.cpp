#include "start/agreement.h"

#include "base/shapes.h"

#include <cmath>

namespace hardbody {
namespace {

bool near(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).norm() <= kStateRounding * b.norm();
}

bool same_dynamics(const ed::Species& a, const ed::Species& b) {
  return std::abs(a.mass / b.mass - 1) <= kStateRounding && near(a.inertia, b.inertia) && a.spins == b.spins;
}

}  // namespace

Agreement compare(const ed::System& system, const Config& config) {
  Agreement result;
  result.number = system.size() == config.number;
  int body = 0;
  for (const ed::Component& component : config.components()) {
    for (int k = 0; k < component.number && body < system.size(); ++k, ++body) {
      const ed::Species& species = system.species_of(body);
      result.shape = result.shape && same_shape(species.shape, component.species.shape, kStateRounding, 0);
      result.dynamics = result.dynamics && same_dynamics(species, component.species);
    }
  }
  return result;
}

}  // namespace hardbody
