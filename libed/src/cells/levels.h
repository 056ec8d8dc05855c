#pragma once

#include "base/archive.h"
#include "cells/grid.h"
#include "cells/near_body.h"

#include <geom/batch.h>

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ed::internal {

/// Returns the class of each extent: the largest class has extents from 0.4 of the largest one on, the class before it
/// from 0.4 of that, and so on. The class of the smallest extents is 0; there are no empty classes.
std::vector<int> size_classes(std::span<const double> extents);

/// Linked cells for bodies of any sizes: in one grid, made for the largest, a small body would have thousands of others
/// within reach.
///
/// The extent of a body is how far it reaches: two bodies may have to know about each other while they are within the
/// sum of their extents. A grid of each class of extents has its bodies alone, a second grid those of the classes
/// before it too. A body looks for its own class and smaller ones in the second grid of its class, and for larger ones
/// in the first grid of each larger class, so that no search reaches farther than the larger of two bodies makes
/// necessary. Where all are of one class there is one grid.
class CellLevels {
 public:
  /// Constructs empty grids for bodies of these extents. `least_scale`: factor by which the box may be scaled while
  /// extents stay. `batches`: see CellGrid.
  CellLevels(std::span<const double> extents, double box, double least_scale = 1,
             const std::optional<geom::InstructionSet>& batches = geom::InstructionSet::best);

  /// Uses the kernel of an instruction set from now on.
  void use(geom::InstructionSet set);

  /// Puts body i (whether placed before or not) at `position`; any image.
  void place(int i, const Eigen::Vector3d& position);

  /// Scales the box with all bodies in it, in all by no less than the constructor's `least_scale`.
  void scale(double factor);

  /// Returns whether the grids would cover searches with extents that are larger by this factor.
  bool cover(double factor) const;

  /// Calls found(others), one grid after another, for all bodies that body i may have to know about if it is at
  /// `position`, nearest images; i itself may be one of them. `buffer` grows as needed.
  template <class Found>
  void search(int i, const Eigen::Vector3d& position, std::vector<NearBody>& buffer, Found&& found) const {
    for_each_grid(i, [&](const CellGrid& grid, double reach) { found(grid.collect(position, reach, buffer)); });
  }

  /// Prefetches data for a later search() with these arguments.
  void fetch(int i, const Eigen::Vector3d& position) const {
    for_each_grid(i, [&](const CellGrid& grid, double reach) { grid.fetch(position, reach); });
  }

  /// Returns the number of classes that have bodies.
  int classes() const { return static_cast<int>(classes_.size()); }

  /// Archives the cells of all grids; read into grids of the same bodies.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    for (auto& c : self.classes_) {
      archive(c.alone);
      if (c.with_smaller) archive(*c.with_smaller);
    }
    if constexpr (Archive::kReads) expect(archive, self.is_sorted(), "the cells hold bodies of other sizes");
  }

 private:
  struct Class {
    double extent;                         ///< largest of its bodies
    CellGrid alone;                        ///< bodies of the class
    std::optional<CellGrid> with_smaller;  ///< bodies of the class and of all before it, if there are any
  };

  /// Returns whether each grid holds the bodies of its classes, where it holds all that it should.
  bool is_sorted() const;

  int class_of(int i) const { return class_of_[static_cast<std::size_t>(i)]; }
  template <class Visit>
  void for_each_grid(int i, Visit&& visit) const {
    const auto own = static_cast<std::size_t>(class_of(i));
    const Class& c = classes_[own];
    visit(c.with_smaller ? *c.with_smaller : c.alone, 2 * c.extent);
    for (std::size_t k = own + 1; k < classes_.size(); ++k) {
      visit(classes_[k].alone, c.extent + classes_[k].extent);
    }
  }

  std::vector<Class> classes_;  ///< the smallest bodies first
  std::vector<int> class_of_;   ///< class of each body
};

}  // namespace ed::internal
