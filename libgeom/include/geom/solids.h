#pragma once

/// @file
/// Platonic and Archimedean solids by name, and faces of polyhedra that are merged where they are in a plane to
/// rounding.

#include <geom/export.h>
#include <geom/polyhedron.h>

#include <Eigen/Core>

#include <span>
#include <string_view>
#include <vector>

namespace geom {

/// Returns the names of all Platonic and Archimedean solids: "tetrahedron", "cube", "octahedron", "dodecahedron",
/// "icosahedron", "truncated tetrahedron", ...
GEOM_EXPORT std::span<const std::string_view> solid_names();

/// Returns the vertices of a Platonic or Archimedean solid, its centre in the origin and its circumradius 1, to
/// rounding. `_` and `-` in the name count as a space. The snub solids, which differ from their mirror images, are of
/// one hand. Throws std::invalid_argument, listing the names, for a name that is none of them.
GEOM_EXPORT std::vector<Eigen::Vector3d> solid_vertices(std::string_view name);

/// merged_faces: faces are merged where all their vertices are within kMergedFaces times the bounding radius of the
/// plane of the largest of them. Dimensionless. Coordinates that have been turned or scaled are some 1e-16 off.
inline constexpr double kMergedFaces = 1e-12;

/// Returns the faces of a polyhedron, those in a plane to rounding merged: vertices of each, anticlockwise seen from
/// outside. Vertices that are then within a face or an edge are in no list. ConvexPolyhedron::faces() are exact:
/// corners that rounding has moved out of a plane make several faces, 24 of a regular dodecahedron's 12.
GEOM_EXPORT std::vector<std::vector<int>> merged_faces(const ConvexPolyhedron& polyhedron);

}  // namespace geom
