#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

namespace ed::internal {

/// A body found near a point, with the vector to its nearest image.
struct NearBody {
  int body;
  Eigen::Vector3d r;
};

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

 private:
  struct Entry {
    Eigen::Vector3d position;
    int body;
  };

  int coordinate(double x) const;
  int cell_of(const Eigen::Vector3d& position) const;

  double box_;
  int cells_;                               ///< along an edge
  std::vector<std::vector<Entry>> bodies_;  ///< of each cell
  std::vector<int> cell_of_body_;           ///< -1: not placed
  std::vector<Eigen::Vector3i> stencil_;    ///< offsets of the cells to look into, each once
};

}  // namespace ed::internal
