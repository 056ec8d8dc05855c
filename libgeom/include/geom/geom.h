#pragma once

/// @file
/// Includes the whole public interface of libgeom.

/// @namespace geom libgeom: distances of smooth convex bodies, and seeds from other libraries.

#include <geom/any_convex.h>
#include <geom/any_shape.h>
#include <geom/batch.h>
#include <geom/check_support.h>
#include <geom/contact_patch.h>
#include <geom/derivatives.h>
#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/half_space.h>
#include <geom/mass.h>
#include <geom/newton.h>
#include <geom/obb.h>
#include <geom/polyhedron.h>
#include <geom/pose.h>
#include <geom/queries.h>
#include <geom/round_shapes.h>
#include <geom/rounded.h>
#include <geom/scene.h>
#include <geom/shape.h>
#include <geom/shape_variant.h>
#include <geom/superellipsoid.h>
#include <geom/tolerances.h>
