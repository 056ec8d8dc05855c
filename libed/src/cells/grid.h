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

/// Linked cells of a periodic cubic box: which points are within a given reach of another.
///
/// Bodies of a cell stand in blocks (cell_kernels.h). Its own block comes at the number of the cell, those of a row of
/// cells one after another, and holds the newest bodies, up to a block of them; behind it follow full ones, the newest
/// first.
class CellGrid {
 public:
  /// `batches`: as SimulationOptions has it, which makes no difference but of speed. Throws std::invalid_argument if
  /// the processor or the build does not have the instruction set.
  CellGrid(int number, double box, double reach,
           const std::optional<geom::InstructionSet>& batches = geom::InstructionSet::best);

  /// Puts body i (already placed or not) at `position`; any image.
  void place(int i, const Eigen::Vector3d& position);

  /// Whether bodies within this reach are found.
  bool cover(double reach) const;

  /// Scales the box with all that is in it. The reach is scaled too.
  void scale(double factor);

  /// All bodies within `reach` (at most that of the constructor) of `position`, nearest images; they stand in `buffer`,
  /// which grows as needed and is never shrunk.
  std::span<const NearBody> collect(const Eigen::Vector3d& position, double reach, std::vector<NearBody>& buffer) const;

  /// These bodies are collected soon: asks for the cells' own blocks, in which most of them stand.
  void fetch(const Eigen::Vector3d& position, double reach) const;

  /// The cells, and the order of the bodies in each, as they are; read into a grid of the same number of bodies.
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
  /// Cells are no narrower than reach / kNarrowest, so that along an axis at most this many count.
  static constexpr int kNarrowest = 3;
  static constexpr std::size_t kMostAlong = 2 * kNarrowest + 2;

  /// What a grid holds, but for which block is where.
  struct Content {
    double box = 0;
    int cells = 0;
    std::vector<int> count;                  ///< of bodies in each cell
    std::vector<int> bodies;                 ///< cell by cell, those of its own block last
    std::vector<Eigen::Vector3d> positions;  ///< of each of them
  };
  /// Cells along one axis, and how far each is from a point at least, squared, in widths of a cell.
  struct Along {
    std::array<int, kMostAlong> cell;
    std::array<double, kMostAlong> distance2;
    int count = 0;
  };
  struct Place {
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

  Place find(int i) const;
  void insert(int i, int cell, const Eigen::Vector3d& position);
  void remove(int i);
  void put(Place where, int i, const Eigen::Vector3d& position);

  double box_;
  double reach_;  ///< the most that is asked for
  int cells_;     ///< along an edge
  CellKernel* kernel_;
  LargeVector<CellBlock> blocks_;  ///< one of each cell, and the full ones
  LargeVector<int> next_;          ///< of each block
  std::vector<int> free_;          ///< blocks that are in no cell
  LargeVector<int> count_;         ///< bodies of each cell
  LargeVector<int> cell_of_body_;
};

}  // namespace ed::internal
