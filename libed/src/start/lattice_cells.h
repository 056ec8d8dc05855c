#pragma once

/// Cells and sites of the lattices that bodies start on.
///
/// Sites and the vectors between them are counted in half edges of a cell: all even (simple cubic), or with an even sum
/// (fcc).

#include <ed/shape.h>
#include <ed/start.h>

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace ed::internal {

/// Returns the number of sites in a cell.
int sites_in_cell(Lattice lattice);

/// Returns whether there is a site at p.
bool is_site(Lattice lattice, const Eigen::Vector3i& p);

/// Converts to units of the box's edge.
Eigen::Vector3d in_box(const Eigen::Vector3i& p, const Eigen::Vector3i& cells);

/// Returns one of each pair of opposite vectors between sites whose components are below `reach` (in units of the box),
/// the shortest first: any overlap is along one of these.
std::vector<Eigen::Vector3i> near_vectors(Lattice lattice, const Eigen::Vector3i& cells, const Eigen::Vector3d& reach);

/// Body with its orientation, at no particular position.
struct Turned {
  const BodyShape* shape;
  Eigen::Matrix3d rotation;

  /// Returns the height beyond its centre, in the direction n of the world.
  double height(const Eigen::Vector3d& n) const { return support(*shape, rotation.transpose() * n).height; }
};

/// Returns the extents along the world's axes, the sum of both sides: if two such bodies overlap, their centres are no
/// further apart along any axis.
Eigen::Vector3d reach_of(const std::vector<Turned>& bodies);

/// Returns the smallest box, `box` or larger, in which the two do not overlap with their centres v boxes apart. A
/// larger box only moves them apart along v, because each contains its centre.
double free_box(double box, const Turned& a, const Turned& b, const Eigen::Vector3d& v);

/// Overload for one body on every site of the lattice.
double free_box(double box, Lattice lattice, const Eigen::Vector3i& cells, const Turned& body);

/// Returns the shortest vector between sites, relative to the extents: for ellipsoids its cube is proportional to the
/// largest packing fraction.
double shortest_vector(Lattice lattice, const Eigen::Vector3i& cells, const Eigen::Vector3d& extents);

/// Returns a lower limit of the box: in a smaller one the spheres inscribed in the bodies on two sites overlap, beyond
/// rounding.
double least_box(Lattice lattice, const Eigen::Vector3i& cells, const Turned& body);

/// Returns whether there are no overlaps with this body on all sites of the box.
bool fits(double box, Lattice lattice, const Eigen::Vector3i& cells, const Turned& body);

/// Returns all ways to fill the box with this number of cells, at most `most`, those with the longest shortest vector
/// first.
std::vector<Eigen::Vector3i> ways_to_fill(Lattice lattice, int cells, const Eigen::Vector3d& extents, std::size_t most);

}  // namespace ed::internal
