#pragma once

#include "base/archive.h"
#include "base/large_vector.h"
#include "cells/kernels.h"
#include "cells/near_body.h"

#include <geom/batch.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ed::internal {

/// Linked cells of a periodic cubic box, which find the points within a given reach of another.
///
/// Bodies of a cell are stored in blocks (cells/kernels.h). A cell's own block has the number of the cell, so that
/// those of a row of cells are consecutive. It holds the newest bodies, up to a block of them; it is followed by full
/// blocks, the newest first.
class CellGrid {
 public:
  /// Constructs an empty grid for bodies 0 to number - 1. `batches` is SimulationOptions::batches, which affects only
  /// the speed. `placed`: how many of them it will hold. Throws std::invalid_argument if the processor or the build
  /// does not have the instruction set.
  CellGrid(int number, double box, double reach, const std::optional<geom::InstructionSet>& batches, int placed);
  /// Constructs a grid that will hold all of them.
  CellGrid(int number, double box, double reach,
           const std::optional<geom::InstructionSet>& batches = geom::InstructionSet::best)
      : CellGrid(number, box, reach, batches, number) {}

  /// Uses the kernel of an instruction set from now on.
  void use(geom::InstructionSet set);

  /// Puts body i (whether placed before or not) at `position`; any image.
  void place(int i, const Eigen::Vector3d& position);

  /// Returns whether body i has been placed.
  bool holds(int i) const { return cell_of_body_[static_cast<std::size_t>(i)] != kNone; }

  /// Returns whether bodies within this reach are found.
  bool cover(double reach) const;

  /// Scales the box with all bodies in it. The reach is scaled too.
  void scale(double factor);

  /// Returns all bodies within `reach` (at most that of the constructor) of `position`, nearest images. They are stored
  /// in `buffer`, which grows as needed and is never shrunk.
  std::span<const NearBody> collect(const Eigen::Vector3d& position, double reach, std::vector<NearBody>& buffer) const;

  /// Prefetches data for a later collect() with these arguments: the cells' own blocks, which contain most of the
  /// bodies.
  void fetch(const Eigen::Vector3d& position, double reach) const;

  /// Archives the cells and the order of the bodies in each; they are read into a grid for the same bodies.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    if constexpr (Archive::kReads) {
      Content content;
      archive(content.box, content.cells, content.count, content.bodies, content.positions);
      expect(archive, self.assign(content), "the cells do not hold the bodies");
    } else {
      const Content content = self.content();
      archive(content.box, content.cells, content.count, content.bodies, content.positions);
    }
  }

 private:
  static constexpr int kNone = -1;
  /// Cells are no narrower than reach / kNarrowest, so that at most kMostAlong cells along an axis are within reach.
  static constexpr int kNarrowest = 3;
  static constexpr std::size_t kMostAlong = 2 * kNarrowest + 2;

  /// Content of a grid, without the positions of its blocks.
  struct Content {
    double box = 0;
    int cells = 0;
    std::vector<int> count;                  ///< number of bodies in each cell
    std::vector<int> bodies;                 ///< bodies cell by cell, those of a cell's own block last
    std::vector<Eigen::Vector3d> positions;  ///< position of each of these bodies
  };
  /// Cells along one axis, with a lower bound of the squared distance of each from a point, in widths of a cell.
  struct Along {
    std::array<int, kMostAlong> cell;
    std::array<double, kMostAlong> distance2;
    int count = 0;
  };
  struct BlockLane {
    int block;
    int lane;
  };

  static int choose_cells(int number, double box, double reach);
  void clear();
  Content content() const;
  bool assign(const Content& content);

  double coordinate(double x) const;
  int cell_at(double coordinate) const;
  int cell_of(const Eigen::Vector3d& position) const;
  Along along(double coordinate, double widths) const;
  int wrapped(int k) const { return k < 0 ? k + cells_ : (k >= cells_ ? k - cells_ : k); }
  template <class Found>
  void for_each_cell_near(const Eigen::Vector3d& position, double reach, Found&& found) const;

  BlockLane find(int i) const;
  void insert(int i, int cell, const Eigen::Vector3d& position);
  void remove(int i);
  void put(BlockLane where, int i, const Eigen::Vector3d& position);

  std::size_t placed_;  ///< number of bodies when all have been placed
  double box_;
  double reach_;  ///< largest reach that can be requested
  int cells_;     ///< number of cells along an edge
  CellKernel* kernel_;
  LargeVector<CellBlock> blocks_;  ///< one block of each cell, followed by the full ones
  LargeVector<int> next_;          ///< successor of each block
  std::vector<int> free_;          ///< blocks that are in no cell
  LargeVector<int> count_;         ///< number of bodies in each cell
  LargeVector<int> cell_of_body_;
};

}  // namespace ed::internal
