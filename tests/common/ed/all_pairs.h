#pragma once

/// Pairs of bodies of a system, each in its nearest image.

#include <ed/system.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>

namespace ed_test {

/// Calls visit(a, b, r) for all pairs of bodies, r the vector from the centre of a to the nearest image of b's.
template <class Visit>
void for_each_pair(const ed::System& system, const Visit& visit) {
  for (std::size_t i = 0; i < system.bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < system.bodies.size(); ++j) {
      Eigen::Vector3d r = system.bodies[j].position - system.bodies[i].position;
      for (int k = 0; k < 3; ++k) r[k] -= system.box * std::round(r[k] / system.box);
      visit(system.bodies[i], system.bodies[j], r);
    }
  }
}

}  // namespace ed_test
