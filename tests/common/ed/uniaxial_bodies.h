#pragma once

/// Ellipsoids of revolution in any motion, and comparison to the last bit, for tests of kernels against the code for
/// one pair.

#include "bodies/uniaxial.h"

#include <ed/random.h>
#include <ed/system.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace ed_test {

/// Returns the bits of a number: 0 and -0 differ, NaN equals itself.
inline std::uint64_t bits(double x) {
  return std::bit_cast<std::uint64_t>(x);
}
inline void expect_same_bits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  for (int k = 0; k < 3; ++k) EXPECT_EQ(bits(a[k]), bits(b[k])) << k;
}

/// Returns bodies in a box, with overlaps, each with its own local time; some at rest, some rotating fast or slowly.
inline ed::internal::UniaxialBodies random_bodies(const std::vector<ed::Species>& species, int number, double box,
                                                  ed::Random& random) {
  ed::System system;
  system.box = box;
  system.species = species;
  for (int i = 0; i < number; ++i) {
    ed::Body body;
    body.species = i % static_cast<int>(species.size());
    body.position = box * Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform());
    // Some are along the box's edges, where numbers are exactly 0.
    if (i % 5 != 0) body.rotation = random.rotation();
    body.velocity = i % 7 == 0 ? Eigen::Vector3d(0, 0, 0) : random.normal3();
    body.angular_velocity =
        i % 3 == 0 ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(std::exp(random.normal()) * random.normal3());
    system.bodies.push_back(body);
  }
  ed::internal::UniaxialBodies bodies(system);
  for (int i = 0; i < number; ++i) {
    if (i % 2 == 0) bodies.move(i, 0.3 * random.uniform());
  }
  return bodies;
}

}  // namespace ed_test
