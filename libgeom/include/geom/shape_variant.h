#pragma once

/// @file
/// List of the shapes that libgeom brings.

#include <geom/ellipsoid.h>
#include <geom/superellipsoid.h>

#include <variant>

namespace geom {

/// Closed variant of the shapes that libgeom brings, and of others. This is their one list: a new shape is added here.
template <class... Others>
using AnyShape = std::variant<Ellipsoid, Superellipsoid, Others...>;

/// Body whose kind is chosen at run time (any_shape.h has its functions).
using Shape = AnyShape<>;

}  // namespace geom
