#pragma once

/// @file
/// Functions of shapes that are chosen at run time.

#include <geom/batch.h>
#include <geom/distance.h>
#include <geom/export.h>
#include <geom/mass.h>
#include <geom/newton.h>
#include <geom/obb.h>
#include <geom/pose.h>
#include <geom/shape_variant.h>

#include <Eigen/Core>

#include <span>
#include <string>

namespace geom {

/// Returns `distance` of the shapes inside, with one dispatch a query: one case for all CoreShapes.
GEOM_EXPORT DistanceResult distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                    const DistanceOptions& options = {});

/// Runs `distance_batch` on the shapes inside (batch.h). Pairs of ellipsoids go to the vector kernels; superellipsoids
/// with both exponents 1 count as ellipsoids. Pairs with any other shape go to `distance` one by one and count as
/// `redone`: the kernel of superellipsoids fills the vectors with both bodies of one pair, others have none.
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

/// Returns volume and moments in closed form, without the approximation of mass.h.
GEOM_EXPORT MassProperties mass_properties(const Shape& shape);

/// Returns "capsule of half-length 2 and radius 0.5", for messages.
GEOM_EXPORT std::string description(const Shape& shape);

/// Returns whether the paper's equations are those of the shape: of ellipsoids (spheres too) and superellipsoids. They
/// need f(x) = 0 with second derivatives, which bodies with edges do not have, and which jump where the caps of a
/// capsule begin.
GEOM_EXPORT bool has_equations(const Shape& shape);

/// Returns the smallest box along the body's own axes (obb.h).
GEOM_EXPORT OrientedBox oriented_box(const Shape& shape, const Pose& X_WB);

/// Forwards to the function of newton.h for the shapes inside, where it is documented. All but dual_seed throw
/// std::invalid_argument for a shape without equations (has_equations).
/// @{
GEOM_EXPORT DistanceResult newton_distance(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                           NewtonSystem system, const WitnessPair& seed,
                                           const NewtonOptions& options = {});
GEOM_EXPORT WitnessPair checked_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                     const WitnessPair& seed);
GEOM_EXPORT WitnessPair dual_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);
GEOM_EXPORT WitnessPair centre_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB);
/// @}

namespace kernel {

/// Computes newton_distance without its checks of the seed.
GEOM_EXPORT DistanceResult newton_distance_unchecked(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                                     NewtonSystem system, const WitnessPair& seed,
                                                     const NewtonOptions& options = {});

}  // namespace kernel
}  // namespace geom
