#pragma once

/// Sixfold order of the directions to neighbours in a layer, or in neighbouring columns.

#include "base/archive.h"
#include "observables/lag_sums.h"

#include <ed/system.h>

#include <Eigen/Core>

#include <vector>

namespace ed::internal {

/// Number of neighbours whose directions count.
constexpr int kLayerNeighbours = 6;
/// Largest distance of neighbours along the director, in mean lengths of the bodies along their axes. In the next layer
/// bodies are one length away and more, as is the next body of a column. At 1/2 a column of bodies that follow each
/// other at more than a length would often have no body within this distance; at 1 layers would mix.
constexpr double kLayerReach = 2.0 / 3;

/// Hexatic order of one frame, or sums of it over frames.
struct HexaticOrder {
  double coherent = 0;  ///< |mean of psi_6 over bodies|
  double local = 0;     ///< mean of |psi_6| over bodies

  HexaticOrder& operator+=(const HexaticOrder& other);

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.coherent, self.local);
  }
};

/// Returns the order of psi_6 = mean of exp(6 i theta) over the bonds of a body, theta the angle of a bond in the plane
/// across the director, as that of Nelson and Halperin, Phys. Rev. B 19 (1979) 2457, in two dimensions. Bonds lead to
/// the six bodies that are nearest in this plane among those within `reach` along the director; to all of these if
/// there are fewer. Nearest images in a cubic box.
HexaticOrder hexatic_order(const std::vector<Eigen::Vector3d>& positions, double box, const Eigen::Vector3d& director,
                           double reach);

/// Returns the positions of the bodies that have an orientation.
std::vector<Eigen::Vector3d> oriented_positions(const std::vector<Eigen::Vector3d>& positions,
                                                const std::vector<BodyRange>& ranges);

/// Returns the mean length along their axes of the bodies that have an orientation; 0 if none has one.
double axial_length(const System& system, const std::vector<BodyRange>& ranges);

}  // namespace ed::internal
