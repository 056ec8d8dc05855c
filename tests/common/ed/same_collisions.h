#pragma once

/// Comparison of the first collisions of two runs.

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

namespace ed_test {

/// Tolerance of times. Contacts that are found from other neighbours, times and normals have different rounding errors
/// (about 1e-15 of the time), and the dynamics multiplies them: in the first 1000 collisions, some four a body, to
/// 1e-12 for ellipsoids of revolution, 2e-11 for other round bodies, 3e-10 where faces meet. A wrong or missing
/// collision changes times by a considerable part of the mean time between collisions, 1e-4 or more.
inline constexpr double kSameTime = 1e-9;

inline std::vector<ed::Collision> first_collisions(const ed::System& system, const ed::SimulationOptions& options,
                                                   std::size_t number = 1000) {
  ed::Simulation simulation(system, options);
  simulation.record_collisions(number);
  simulation.run_collisions(number);
  EXPECT_EQ(simulation.counters().overlaps, 0U);
  EXPECT_EQ(simulation.counters().parting_contacts, 0U);
  EXPECT_EQ(simulation.collisions().size(), number);
  return simulation.collisions();
}

/// Expects the pairs to be the same, times to agree, and to be in order.
inline void expect_same(const std::vector<ed::Collision>& a, const std::vector<ed::Collision>& b,
                        const std::string& what, double same_time = kSameTime) {
  ASSERT_EQ(a.size(), b.size()) << what;
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ASSERT_EQ(a[k].i, b[k].i) << what << ", collision " << k;
    ASSERT_EQ(a[k].j, b[k].j) << what << ", collision " << k;
    worst = std::max(worst, std::abs(a[k].time - b[k].time));
    EXPECT_GE(b[k].time, b[k > 0 ? k - 1 : 0].time) << what;
  }
  std::printf("%s: times differ by %.1e at most\n", what.c_str(), worst);
  EXPECT_LE(worst, same_time) << what;
}

/// Variant of running the event loop.
struct Mode {
  const char* name;
  ed::Finder finder;
  ed::Neighbours neighbours;
  ed::DistanceMethod distance = ed::DistanceMethod::dual;
  ed::ContactRoot root = ed::ContactRoot::newton;

  ed::SimulationOptions options(double eps_d) const {
    ed::SimulationOptions options;
    options.neighbours = neighbours;
    options.contact.finder = finder;
    options.contact.distance = distance;
    options.contact.root = root;
    options.contact.eps_d = eps_d;
    return options;
  }
};

}  // namespace ed_test
