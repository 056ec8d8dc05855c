#pragma once

/// Lattice of a periodic scene: which cell a point is in, and which images of boxes are near.

#include "scene/box.h"

#include <geom/scene.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace geom::scene {

/// Largest error of unit vectors across two lattice vectors, whose directions span an area of at least 1e-6.
inline constexpr double kOpenRounding = 1e-9;

class Images {
 public:
  /// Throws std::invalid_argument for vectors that are not finite or nearly in one plane.
  explicit Images(const Lattice& lattice);

  bool periodic() const { return directions_ > 0; }

  /// Returns the cell of a point: its coordinates along the lattice vectors, rounded; 0 along those that are none.
  /// Throws std::invalid_argument, naming `what`, for cells that are too far away for exact numbers.
  Eigen::Vector3d cell(const Eigen::Vector3d& point, const char* what) const;

  /// Returns the lattice vector with these numbers, whole ones.
  Eigen::Vector3d vector(const Eigen::Vector3d& cell) const { return vectors_ * cell; }

  /// Returns unit vectors across all lattice vectors and across each other, accurate to kOpenRounding.
  std::span<const Eigen::Vector3d> open() const { return std::span(open_).first(open_count_); }

  /// Returns a lower bound of the distance of two boxes, wherever lattice vectors move them: that across the lattice.
  double open_gap(const Box3& a, const Box3& b) const;

  double shortest() const { return shortest_; }  ///< smallest length of a lattice vector; infinite without any
  double longest() const { return longest_; }    ///< largest length of a lattice vector

  /// Returns how many cells `for_each_near` looks at.
  double count_near(const Box3& moved, const Box3& other, double reach) const {
    return moved.empty() || other.empty() ? 0 : range(moved, other, reach).count;
  }

  /// Throws std::invalid_argument for more than 1e8 cells, NaN included.
  static void check_count(double count);

  /// Calls visit(cell) for all cells such that the box moved there is within `reach` of the other one, and for some
  /// more. Open space has one cell. Periodic: throws std::invalid_argument for more than 1e8 cells.
  /// `visit` returns false to stop. Returns whether it went on to the end.
  template <class Visit>
  bool for_each_near(const Box3& moved, const Box3& other, double reach, const Visit& visit) const;

 private:
  /// Cells whose lattice vectors may be within [low, high].
  struct Range {
    Eigen::Vector3d low, high;
    Eigen::Vector3d first, last;
    double count = 1;
  };
  Range range(const Box3& moved, const Box3& other, double reach) const;

  Eigen::Matrix3d vectors_;
  Eigen::Matrix3d inverse_;  ///< rows: coordinates along the lattice vectors; 0 for those that are none
  std::array<Eigen::Vector3d, 3> open_;
  std::size_t open_count_ = 0;
  int directions_ = 0;
  double shortest_ = std::numeric_limits<double>::infinity();
  double longest_ = 0;
};

template <class Visit>
bool Images::for_each_near(const Box3& moved, const Box3& other, double reach, const Visit& visit) const {
  if (moved.empty() || other.empty()) return true;
  if (!periodic()) return visit(Eigen::Vector3d::Zero().eval());
  const Range near = range(moved, other, reach);
  check_count(near.count);
  const auto& [low, high, first, last, count] = near;
  Eigen::Vector3d cell;
  for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0]) {
    for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1]) {
      for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2]) {
        const Eigen::Array3d by = vector(cell).array();
        if ((by >= low.array()).all() && (by <= high.array()).all() && !visit(cell)) return false;
      }
    }
  }
  return true;
}

}  // namespace geom::scene
