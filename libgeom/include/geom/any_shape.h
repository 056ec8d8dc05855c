#pragma once

/// @file
/// Functions of shapes that are chosen at run time.

#include <geom/batch.h>
#include <geom/distance.h>
#include <geom/export.h>
#include <geom/newton.h>
#include <geom/obb.h>
#include <geom/pose.h>
#include <geom/shape_variant.h>

#include <Eigen/Core>

#include <span>

namespace geom {

/// Returns `distance` of the shapes inside, with one dispatch a query.
GEOM_EXPORT DistanceResult distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                    const DistanceOptions& options = {});

/// Runs `distance_batch` on the shapes inside (batch.h). Pairs of ellipsoids go to the vector kernels; superellipsoids
/// with both exponents 1 count as ellipsoids. Pairs with any other superellipsoid go to `distance` one by one and count
/// as `redone`: their kernel fills the vectors with both bodies of one pair.
GEOM_EXPORT BatchSummary distance_batch(std::span<const Shape> a, std::span<const Pose> X_WA, std::span<const Shape> b,
                                        std::span<const Pose> X_WB, std::span<DistanceResult> results,
                                        const BatchOptions& options = {});

/// Forwards to the member function of the shape inside, where it is documented.
/// @{
GEOM_EXPORT Support support(const Shape& shape, const Eigen::Vector3d& n);
GEOM_EXPORT double bounding_radius(const Shape& shape);
GEOM_EXPORT double inscribed_radius(const Shape& shape);
GEOM_EXPORT double volume(const Shape& shape);
GEOM_EXPORT Eigen::Vector3d inertia(const Shape& shape, double mass);
/// @}

/// Forwards to the function of obb.h or newton.h for the shapes inside, where it is documented.
/// @{
GEOM_EXPORT OrientedBox oriented_box(const Shape& shape, const Pose& X_WB);
GEOM_EXPORT DistanceResult newton_distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                           NewtonSystem system, const WitnessPair& seed,
                                           const NewtonOptions& options = {});
GEOM_EXPORT WitnessPair dual_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);
GEOM_EXPORT WitnessPair centre_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);
/// @}

}  // namespace geom
