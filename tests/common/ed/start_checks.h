#pragma once

/// Properties that every start must have, however it was made.

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ed_test {

/// Tolerance of sums over some hundred bodies, each term rounded.
inline constexpr double kRounding = 1e-12;

inline double spin_kT(const ed::System& system) {
  return 2 * ed::kinetic_state(system).spin_energy / system.size();
}

inline void expect_sound(const ed::System& system, double packing_fraction) {
  EXPECT_NEAR(ed::packing_fraction(system) / packing_fraction, 1, 1e-14);
  const ed::Audit audit = ed::audit(system);
  EXPECT_TRUE(audit.finite);
  EXPECT_EQ(audit.overlaps, 0);
  EXPECT_GT(audit.minimum_distance, 0);
  EXPECT_NEAR(audit.kinetic.translational_kT, 1, kRounding);
  EXPECT_NEAR(audit.kinetic.rotational_kT, 1, kRounding);
  double heaviest = 0;
  for (const ed::Species& species : system.species) heaviest = std::max(heaviest, species.mass);
  EXPECT_NEAR(audit.kinetic.momentum.norm() / std::sqrt(heaviest), 0, kRounding);
  for (const ed::Body& body : system.bodies) ASSERT_LE(body.position.cwiseAbs().maxCoeff(), 0.5 * system.box);
  ed::Simulation simulation(system);
  simulation.run_collisions(2000);
  EXPECT_EQ(simulation.counters().overlaps, 0U);
  EXPECT_EQ(ed::audit(simulation.system()).overlaps, 0);
}

/// Returns <P2> of the body axis about z.
inline double order_about_z(const ed::System& system, int axis) {
  double sum = 0;
  for (const ed::Body& body : system.bodies) sum += 1.5 * body.rotation(2, axis) * body.rotation(2, axis) - 0.5;
  return sum / system.size();
}

/// Returns <x^4>, x = cos(theta), by quadrature with the m that gives this <P2(x)>.
inline double maier_saupe_fourth_moment(double order) {
  const auto moment = [](double m, int k) {
    double sum = 0;
    for (int i = 0; i < 20000; ++i)
      sum += std::pow((i + 0.5) / 20000, k) * std::exp(m * std::pow((i + 0.5) / 20000, 2));
    return sum;
  };
  double low = 0;
  double high = 50;
  for (int i = 0; i < 50; ++i) {
    const double m = 0.5 * (low + high);
    (1.5 * moment(m, 2) / moment(m, 0) - 0.5 < order ? low : high) = m;
  }
  return moment(low, 4) / moment(low, 0);
}

}  // namespace ed_test
