#pragma once

/// Large starts: a small periodic box of the same mixture, repeated along all three edges.

#include <ed/random.h>
#include <ed/system.h>

#include <vector>

namespace ed::internal {

/// What the copies of a tile's component become.
struct Copies {
  int wanted = 0;  ///< others are taken out
  /// Bodies of this component; or, of several, one each: bodies of one shape but for their sizes, none larger than the
  /// one that is copied, within which they lie.
  std::vector<int> components;
};

/// `along`^3 boxes side by side, of these components each; 1: not repeated. They hold a few bodies more than wanted,
/// less than one box has of each component, which are then taken out again. Bodies that have sizes of their own are
/// sorted by size, and the largest of each `along`^3 that follow each other stands in the tile for all of them.
struct Tiling {
  int along = 1;
  std::vector<Component> tile;
  std::vector<Copies> copies;   ///< of each component of the tile; empty if it is not repeated
  double packing_fraction = 0;  ///< of a tile: what is wanted, the bodies that are taken out and what others are larger
};

/// As few boxes as leave no more than `most` bodies to each; fewer where they would be too small for nearest images or
/// bodies that are taken out, or are smaller than those that are copied, would be more than 2 % of the number or of the
/// volume (a mixture of many species with few bodies each is not repeated, nor one of few large and many small ones).
Tiling tiling_of(const std::vector<Component>& components, double packing_fraction, int most);

/// The box that is made of tiles, its bodies in the order of the components; which copies are taken out, and which copy
/// becomes which body, is drawn. Velocities are those of the tile.
System repeat(const System& tile, const Tiling& tiling, const std::vector<Component>& components, Random& random);

}  // namespace ed::internal
