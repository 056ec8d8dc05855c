#pragma once

#include <geom/kernel/core.h>

#include <Eigen/Core>

#include <span>

namespace geom::kernel {

/// Returns the convex hull of points, with faces of any number of edges; no decision depends on rounding. Throws
/// std::invalid_argument if there are fewer than four points, one of them is not finite or too large, or all of them
/// lie in a plane.
Hull convex_hull(std::span<const Eigen::Vector3d> points);

/// Computes normals and offsets of the faces from the vertices. `exact`, if given, is the hull that this one has been
/// moved or scaled from: normals of narrow faces, which rounding of the vertices turns, remain those of it.
void set_planes(Hull& hull, const Hull* exact = nullptr);

/// Volume and moments of a hull, wherever the origin is.
struct HullMoments {
  double volume = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();         ///< centre of mass
  Eigen::Matrix3d second_moment = Eigen::Matrix3d::Zero();  ///< mean of x x^T over the body
};
HullMoments moments(const Hull& hull);

}  // namespace geom::kernel
