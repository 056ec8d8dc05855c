#pragma once

/// Lines of constant value over a grid that may have holes and ragged edges.

#include <cstddef>
#include <optional>
#include <vector>

namespace hardbody {

/// Measured point of the plane.
struct Sample {
  double x;
  double y;
  double value;
};

/// Values over all combinations of some x and some y, as far as they are known.
struct Lattice {
  std::vector<double> x;                      ///< ascending
  std::vector<double> y;                      ///< ascending
  std::vector<std::optional<double>> values;  ///< value at x[i], y[j]: i * y.size() + j

  const std::optional<double>& at(std::size_t i, std::size_t j) const { return values[i * y.size() + j]; }
};

/// Returns the lattice of the samples; several samples at one point are averaged. Missing values between two known
/// values of one x are interpolated along y, linearly, so that every x may have its own y.
Lattice lattice_of(const std::vector<Sample>& samples);

/// Returns whether the lattice has any cell, or triangle, for lines to pass through; false if each x has a single y.
bool has_cells(const Lattice& lattice);

struct PlanePoint {
  double x;
  double y;
};

/// Line of constant value; a closed one ends where it begins.
using ContourLine = std::vector<PlanePoint>;

/// Returns the lines on which the interpolated values are `level`, by marching squares: linear along the edges of the
/// lattice, through cells with four known corners (saddles by the mean of the corners) and, by triangles, with three.
/// If a column ends up to four rows before the one beside it, triangles fan out from its end. The longest line comes
/// first.
std::vector<ContourLine> contour_lines(const Lattice& lattice, double level);

}  // namespace hardbody
