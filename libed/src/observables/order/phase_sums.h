#pragma once

/// Order of single frames beyond that of their axes: Bragg peaks, cubatic order, bonds.

#include "base/archive.h"
#include "observables/order/hexatic.h"
#include "observables/structure.h"

#include <ed/observables.h>
#include <ed/snapshot.h>

#include <Eigen/Core>

#include <vector>

namespace ed::internal {

/// Sums over the frames whose structure is measured.
struct PhaseSums {
  std::vector<double> intensities;  ///< S(q) / N of each wave vector that is followed
  std::vector<double> cubatic;      ///< cubatic order of each part of the structure; 0 where axes are not known
  double q4 = 0;                    ///< q_4, averaged over bodies
  double q6 = 0;
  HexaticOrder hexatic;

  void add(const PhaseSums& other);

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.intensities, self.cubatic, self.q4, self.q6, self.hexatic);
  }
};

/// Wave vectors that a run follows: those of its first frame with the largest S(q) / N, of all, of those near the
/// director, and of those near the plane across it.
std::vector<Eigen::Vector3i> followed_vectors(const StructureGrid& grid, const Snapshot& first,
                                              const Eigen::Vector3d& director);

/// Returns the order of a frame. `parts`: bodies of each part of the structure, of which those with three axes have
/// cubatic order.
PhaseSums phase_of(const StructureGrid& grid, const Snapshot& now, const std::vector<BodyRange>& parts,
                   const std::vector<Eigen::Vector3i>& vectors, const BondOptions& bonds);

/// A wave vector is along the director, or in the plane across it, to this angle of 15 degrees.
constexpr double kCosineAlong = 0.9659258262890683;
constexpr double kCosineAcross = 0.25881904510252074;

}  // namespace ed::internal
