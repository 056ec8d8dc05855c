#pragma once

/// Limits of the thickness of envelopes and of the size of boxes, and of how long envelopes are kept.

#include <algorithm>

namespace ed::internal {

/// Grid of cells of the paper's algorithm, and the number of them that a box must have.
class CellLayout {
 public:
  /// Returns the number of cells along an edge: they are at least 2 R wide, so that bodies that touch are in adjacent
  /// ones.
  static int cells_along(double box, double bounding_radius) {
    return static_cast<int>(std::min(kMostCells, box / (2 * bounding_radius * (1 + 4 * kOvershoot))));
  }
  /// Largest number of cells along an edge: positions are rounded by 1e-16 of the box, which must be small beside
  /// kOvershoot cells.
  static constexpr double kMostCells = 16384;
  /// Least number of cells along an edge: with fewer a neighbouring cell is met on both sides.
  static constexpr int kLeastCells = 3;
  static double smallest_box(double bounding_radius) {
    return kLeastCells * 2 * bounding_radius * (1 + 8 * kOvershoot);
  }

 protected:
  /// Distance beyond a face at which a body counts as having left its cell, in cell widths.
  static constexpr double kOvershoot = 1e-10;
};

/// Thickness of the thinnest envelope in use, in units of the bounding radius.
inline constexpr double kThinnestEnvelope = 0.02;
/// Thickness of the thinnest box around a body of any shape, in units of the smallest inscribed radius.
inline constexpr double kThinnestOriented = 0.02;

/// An envelope that lasts longer than this is not made anew early; in units of the time in which the surface can cross
/// the thickness.
inline constexpr double kWorthwhile = 0.15;

/// Returns the smallest box in which the nearest image of a neighbour is the only one that can touch. Neighbours'
/// envelope centres are within 2 R + 2 delta of each other, their centres then within 2 R + 4 delta, which must be
/// below half the box.
inline double smallest_image_box(double bounding_radius) {
  return 2 * (2 + 4 * kThinnestEnvelope) * bounding_radius;
}

/// Returns the thickest envelope for which the nearest image is safe in this box.
inline double thickest_envelope(double box, double bounding_radius) {
  return (0.5 * box - 2 * bounding_radius) / 4;
}

/// Returns an upper bound of the angle between unit vectors a chord apart: 2 asin(c/2) = c + c^3/24 + 3 c^5/640 + ...,
/// whose tail after the second term is below c^5/120 for c <= 1.
inline double angle_bound(double chord) {
  if (!(chord <= 1)) return 3.1416;
  const double c2 = chord * chord;
  return chord * (1 + c2 * (1.0 / 24 + c2 / 120));
}

}  // namespace ed::internal
