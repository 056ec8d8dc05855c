#pragma once

/// @file
/// List of the shapes that libgeom brings.

#include <geom/ellipsoid.h>
#include <geom/polyhedron.h>
#include <geom/round_shapes.h>
#include <geom/rounded.h>
#include <geom/superellipsoid.h>

#include <variant>

namespace geom {

/// Closed variant of the shapes that libgeom brings, and of others. This is their one list: a new shape is added here,
/// behind the others, as files store the index.
template <class... Others>
using AnyShape = std::variant<Ellipsoid, Superellipsoid, Sphere, Capsule, Box, ConvexPolyhedron, Rounded<Box>,
                              Rounded<ConvexPolyhedron>, Cylinder, Cone, Rounded<Cylinder>, Rounded<Cone>, Others...>;

/// Body whose kind is chosen at run time (any_shape.h has its functions). A half-space is none (half_space.h).
using Shape = AnyShape<>;

}  // namespace geom
