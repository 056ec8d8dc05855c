#pragma once

#include "patch/surface.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace geom::patch {

/// Corner of a polygon, and what bounds the polygon from there to the next corner.
struct Corner {
  Vector2d place = Vector2d::Zero();
  std::uint64_t side = 0;
  bool is_done = false;  ///< whether the corner is one of the patch
  double outside = 0;    ///< distance from the patch, once it is done
};

/// Convex polygon, anticlockwise.
using Polygon = std::vector<Corner>;

/// Removes what is beyond a line by more than `slack`; the new side has this name. Returns whether anything is left.
bool cut(Polygon& polygon, const Vector2d& normal, double reach, std::uint64_t side, double slack);

/// Leaves out sides up to this length. Returns the number of corners that remain.
std::size_t merge(Polygon& polygon, double shortest);

/// Returns the signed area.
double area(const Polygon& polygon);

/// Returns the centroid, of a polygon without area the mean of the corners.
Vector2d centroid(const Polygon& polygon);

/// Returns the two corners that are furthest apart; both 0 for one.
std::pair<std::size_t, std::size_t> longest(const Polygon& polygon);

/// Returns the width of the polygon across a unit vector.
double width_across(const Polygon& polygon, const Vector2d& along);

/// Leaves out corners, each time the one whose triangle with its neighbours is smallest, until there are at most
/// `most`.
void reduce(Polygon& polygon, std::size_t most);

}  // namespace geom::patch
