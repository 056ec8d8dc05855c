#pragma once

/// Table of the pair gaps: which one belongs to two bodies in flight. Every search for a contact of general bodies asks
/// here. Ellipsoids of revolution and capsules whose inertia shares their axis have a state of their own
/// (bodies/uniaxial.h), with UniaxialGap, RodGap and MixedGap.
///
/// | A                    | B          | distance (ed::distance)                 | pair gap   | bracketing |
/// |----------------------|------------|-----------------------------------------|------------|------------|
/// | (super)ellipsoids    | the same   | geom::distance of the two kinds         | SupportGap | yes        |
/// | cores with balls     | libgeom's  | geom::distance of the two kinds         | ConvexGap  | refused    |
/// | a user's             | any        | PairDistance of A, of B, geom::distance | ConvexGap  | refused    |
///
/// Cores with balls swept over them: capsules, boxes, polyhedra, cylinders, cones, rounded ones; spheres too, for which
/// the bracketing finder has equations.

#include "contact/body_shapes.h"
#include "contact/convex/gap.h"
#include "contact/support_gap.h"
#include "motion/rigid_motion.h"

#include <ed/shape.h>

#include <geom/shape_variant.h>

#include <Eigen/Core>

#include <optional>
#include <utility>

namespace ed::internal {

/// Shape with what the pair gaps take of it.
struct GapShape {
  explicit GapShape(const BodyShape& body)
      : convex(body), norm(norm_body(body)), implicit(shape_with_equations(body)) {}

  ConvexBody convex;                    ///< shape as ConvexGap takes it
  std::optional<NormBodyShape> norm;    ///< shape as SupportGap takes it
  std::optional<geom::Shape> implicit;  ///< shape as Finder::bracketing takes it
};

/// Returns f(gap) with the pair gap of two bodies in flight. `r`: vector from A's centre to B's at `now`, in the image
/// that is meant.
template <class F>
decltype(auto) with_pair_gap(const GapShape& A, const RigidMotion& a, const GapShape& B, const RigidMotion& b,
                             const Eigen::Vector3d& r, double now, F&& f) {
  if (A.norm && B.norm) return std::forward<F>(f)(SupportGap(*A.norm, a, *B.norm, b, r, now));
  return std::forward<F>(f)(ConvexGap(A.convex, a, B.convex, b, r, now));
}

}  // namespace ed::internal
