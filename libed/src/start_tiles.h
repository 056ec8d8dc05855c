#pragma once

/// Large starts: a small periodic box of the same mixture, repeated along all three edges.

#include <ed/random.h>
#include <ed/system.h>

#include <vector>

namespace ed::internal {

/// `along`^3 boxes side by side, of these components each; 1: not repeated. They hold a few bodies more than wanted,
/// less than one box has, which are then taken out again.
struct Tiling {
  int along = 1;
  std::vector<Component> tile;
  double packing_fraction = 0;  ///< of a tile: what is wanted, and the bodies that are taken out
};

/// As few boxes as leave no more than `most` bodies to each; fewer where they would be too small for nearest images or
/// more than 2 % of the bodies would have to be taken out (a mixture of many species with few bodies each is not
/// repeated).
Tiling tiling_of(const std::vector<Component>& components, double packing_fraction, int most);

/// The box that is made of tiles, its bodies in the order of the components; which bodies of a species are taken out is
/// drawn. Velocities are those of the tile.
System repeat(const System& tile, const Tiling& tiling, const std::vector<Component>& components, Random& random);

}  // namespace ed::internal
