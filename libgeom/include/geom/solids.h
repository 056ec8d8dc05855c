#pragma once

/// @file
/// Platonic and Archimedean solids by name.

#include <geom/export.h>

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

}  // namespace geom
