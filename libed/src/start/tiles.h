#pragma once

/// Large starts: a small periodic box of the same mixture (the tile), repeated along all three edges.

#include <ed/random.h>
#include <ed/system.h>

#include <vector>

namespace ed::internal {

/// Use of the copies of a tile's component.
struct Copies {
  int wanted = 0;  ///< number of copies kept; the others are removed
  /// Components of the copies: a single one for all; or one for each copy, which are bodies of one shape but for their
  /// sizes, none larger than the one that is copied, within which they lie.
  std::vector<int> components;
};

/// Tile and its repetition: `along`^3 boxes side by side, with these components in each; 1: not repeated. They hold a
/// few bodies more than wanted, fewer than one box has of each component, which are then removed. Bodies with
/// individual sizes are sorted by size and grouped by `along`^3; in the tile each group is represented by its largest
/// body.
struct Tiling {
  int along = 1;
  std::vector<Component> tile;
  std::vector<Copies> copies;  ///< copies of each component of the tile; empty if it is not repeated
  /// Packing fraction of a tile: the wanted one, plus the bodies that are removed and the excess size of
  /// representatives.
  double packing_fraction = 0;
};

/// Returns the tiling with the fewest boxes that leave no more than `most` bodies to each. There are fewer boxes if
/// they would be too small for nearest images, or if the bodies that are removed, or the excess size of
/// representatives, would exceed 2 % of the number or of the volume (a mixture of many species with few bodies each is
/// not repeated, nor one of few large and many small ones).
Tiling tiling_of(const std::vector<Component>& components, double packing_fraction, int most);

/// Builds the box from tiles, its bodies in the order of the components. The copies that are removed, and the
/// assignment of copies to bodies, are drawn at random. Velocities are those of the tile.
System repeat(const System& tile, const Tiling& tiling, const std::vector<Component>& components, Random& random);

}  // namespace ed::internal
