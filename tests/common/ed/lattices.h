#pragma once

/// Points whose structure is known.

#include <ed/random.h>

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace ed_test {

using Eigen::Vector3d;

/// Returns a lattice of n^3 cubic cells of edge 1 with this basis.
inline std::vector<Vector3d> lattice(int n, const std::vector<Vector3d>& basis) {
  std::vector<Vector3d> sites;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < n; ++z) {
        for (const Vector3d& b : basis) sites.push_back(Vector3d(x, y, z) + b);
      }
    }
  }
  return sites;
}

inline const std::vector<Vector3d> kSimple = {{0, 0, 0}};
inline const std::vector<Vector3d> kBodyCentred = {{0, 0, 0}, {0.5, 0.5, 0.5}};
inline const std::vector<Vector3d> kFaceCentred = {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};

/// Returns points at random in a box.
inline std::vector<Vector3d> points(int number, double box, std::uint64_t seed) {
  ed::Random random(seed);
  std::vector<Vector3d> list;
  for (int i = 0; i < number; ++i) list.push_back(box * Vector3d(random.uniform(), random.uniform(), random.uniform()));
  return list;
}

}  // namespace ed_test
