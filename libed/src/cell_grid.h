#pragma once

#include "large_vector.h"
#include "near_body.h"

#include <ed/internal/archive.h>

#include <Eigen/Core>

#include <span>
#include <vector>

namespace ed::internal {

/// Linked cells of a periodic cubic box: which points are within a given reach of another.
class CellGrid {
 public:
  /// Cells are about reach / 2 wide: fewer bodies to look at than with cells of width `reach`, few more cells.
  CellGrid(int number, double box, double reach);

  /// Puts body i (already placed or not) at `position`; any image.
  void place(int i, const Eigen::Vector3d& position);

  /// Scales the box with all that is in it. The reach is scaled too.
  void scale(double factor);

  /// All bodies within `reach` (at most that of the constructor) of `position`, nearest images; they stand in `buffer`,
  /// which grows as needed and is never shrunk.
  std::span<const NearBody> collect(const Eigen::Vector3d& position, double reach, std::vector<NearBody>& buffer) const;

  /// The cells, and the order of the bodies in each, as they are; read into a grid of the same number of bodies.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    const std::size_t number = self.bodies_.size();
    archive(self.box_, self.cells_, self.first_, self.bodies_, self.stencil_);
    expect(archive, self.bodies_.size() == number && self.filled(), "the cells do not hold the bodies");
  }

 private:
  static constexpr int kNone = -1;
  /// Cells are no narrower than reach / 2 but for rounding: up to three on either side count.
  static constexpr std::size_t kMostOffsets = std::size_t{7} * 7 * 7;

  /// A body, and the list of its cell from it on.
  struct Entry {
    Eigen::Vector3d position;
    int cell = kNone;  ///< none: not placed
    int next = kNone;

    template <class Archive, class Self>
    static void fields(Archive& archive, Self& self) {
      archive(self.position, self.cell, self.next);
    }
  };

  bool filled() const;

  int coordinate(double x) const;
  int cell_of(const Eigen::Vector3d& position) const;

  double box_;
  int cells_;               ///< along an edge
  LargeVector<int> first_;  ///< body of each cell
  LargeVector<Entry> bodies_;
  std::vector<Eigen::Vector3i> stencil_;  ///< offsets of the cells to look into, each once
};

}  // namespace ed::internal
