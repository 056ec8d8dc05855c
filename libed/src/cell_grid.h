#pragma once

#include <Eigen/Core>

#include <vector>

namespace ed::internal {

/// Linked cells of a periodic cubic box: which bodies may be within a given reach of a point.
class CellGrid {
 public:
  /// Cells are about reach / 2 wide: fewer bodies to look at than with cells of width `reach`, few more cells.
  CellGrid(int number, double box, double reach);

  /// Puts body i (already placed or not) into the cell of `position`; any image.
  void place(int i, const Eigen::Vector3d& position);

  /// Scales the box with all that is in it. The reach that `collect` covers scales along.
  void scale(double factor) { box_ *= factor; }

  /// Appends all bodies in cells that reach within `reach` of the cell of `position`.
  void collect(const Eigen::Vector3d& position, std::vector<int>& out) const;

 private:
  int coordinate(double x) const;
  int cell_of(const Eigen::Vector3d& position) const;

  double box_;
  int cells_;                        ///< along an edge
  std::vector<std::vector<int>> bodies_;  ///< of each cell
  std::vector<int> cell_of_body_;    ///< -1: not placed
  std::vector<Eigen::Vector3i> stencil_;  ///< offsets of the cells to look into, each once
};

}  // namespace ed::internal
