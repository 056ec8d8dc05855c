#pragma once

/// @file
/// The whole public interface of libgeom.

/// @namespace geom
/// Distances of smooth convex bodies: libgeom, and seeds from other libraries.

#include <geom/any_shape.h>
#include <geom/batch.h>
#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/mass.h>
#include <geom/newton.h>
#include <geom/obb.h>
#include <geom/pose.h>
#include <geom/queries.h>
#include <geom/shape.h>
#include <geom/superellipsoid.h>
#include <geom/tolerances.h>
