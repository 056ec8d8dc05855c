#pragma once

/// Shape as ConvexGap needs it: a convex core with a ball swept over it.

#include "motion/top_state.h"

#include <ed/shape.h>

#include <geom/kernel/core.h>

#include <Eigen/Core>

#include <optional>

namespace ed::internal {

/// Returns the core of a shape that is a geom::CoreShape; nullopt for any other. A hull is that of
/// the shape, of which a copy must live on.
std::optional<geom::kernel::CoreView> core_of(const BodyShape& shape);

/// Shape, and its support function less that of the largest ball that is known to roll inside its surface: what is
/// left is the support function of a convex body too, the core.
struct ConvexBody {
  explicit ConvexBody(const BodyShape& body);

  /// Returns the support of the core along m, of any length, of a body turned by R: the point in the world's axes.
  geom::Support core_support(const Eigen::Matrix3d& R, const Eigen::Vector3d& m) const {
    const Eigen::Vector3d seen = transposed_product(R, m);
    if (core) {
      const geom::Support s = geom::kernel::core_support(*core, seen);
      return {s.height, product(R, s.point)};
    }
    const geom::Support s = support(shape, seen);
    if (ball == 0) return {s.height, product(R, s.point)};
    const double length = seen.norm();
    return {s.height - ball * length, product(R, s.point) - ball / length * m};
  }

  /// Returns whether the core is a point or a segment along z.
  bool line() const {
    return core && (core->kind == geom::kernel::CoreKind::point || core->kind == geom::kernel::CoreKind::segment);
  }

  /// Returns whether the core is a cylinder or cone.
  bool rims() const { return core && core->kind == geom::kernel::CoreKind::frustum; }
  /// Returns whether the core is known to be a polytope.
  bool polytope() const { return core && !rims(); }

  /// Returns whether it is a user's shape that says nothing about its curvature.
  bool may_be_sharp() const { return !core && !smooth && ball == 0; }

  BodyShape shape;
  std::optional<geom::kernel::CoreView> core;  ///< core that the ball is swept over, if the shape has one
  bool smooth;                                 ///< whether it is an ellipsoid or superellipsoid
  bool own_distance;                           ///< whether a user's PairDistance is to be asked
  double bounding_radius;
  double lever;       ///< turning_lever (body_shapes.h)
  double ball;        ///< radius of the ball, a lower bound of the radii of curvature
  double core_reach;  ///< bounding radius of the core
  double core_inner;  ///< radius of a ball about the centre inside the core
};

}  // namespace ed::internal
