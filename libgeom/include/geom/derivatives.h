#pragma once

/// @file
/// Derivatives of the distance of two bodies with respect to both poses.

#include <geom/any_convex.h>
#include <geom/any_shape.h>
#include <geom/distance.h>
#include <geom/export.h>
#include <geom/half_space.h>
#include <geom/kernel/core.h>
#include <geom/pose.h>
#include <geom/rounded.h>
#include <geom/shape.h>
#include <geom/shape_variant.h>

#include <Eigen/Core>

#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <variant>

namespace geom {

/// Set of derivatives of a distance that exist.
enum class DerivativeStatus {
  twice,  ///< gradient, Hessian and the Jacobians of normal and points
  /// The gradient alone: the closest points are unique, but one of them is at the end of an edge, of a face or of a
  /// round side, where second derivatives jump; or a radius of curvature is infinite on both bodies.
  once,
  /// The gradient by both positions alone: there are many pairs of closest points, as of faces or edges that are
  /// parallel, or a user's support function has a kink there. Turning the bodies gives directional derivatives only.
  by_position,
  none,         ///< no derivative: several normals are equally good, or it is not certain that one is the best
  no_distance,  ///< the distance was declined, or is not that of this pair
};

/// Returns the enumerator's name.
GEOM_EXPORT const char* to_string(DerivativeStatus status);

/// Vectors and matrices by both poses. Without alignment, so that their layout depends on no compiler flag.
/// @{
using PoseGradient = Eigen::Matrix<double, 12, 1, Eigen::DontAlign>;
using PoseHessian = Eigen::Matrix<double, 12, 12, Eigen::DontAlign>;
using PoseJacobian = Eigen::Matrix<double, 3, 12, Eigen::DontAlign>;
/// @}

/// Derivatives of a distance, its normal and its points with respect to x = (dp_A, dtheta_A, dp_B, dtheta_B), all in
/// the world frame: A moves to the rotation exp(dtheta_A) R_A (a turn about A's origin by |dtheta_A| radian) and to the
/// position p_A + dp_A, and B likewise. Lengths are in the user's unit, angles in radian. Numbers that do not exist are
/// NaN; `status` says which those are.
///
/// With s_A and s_B the witness points less the positions, the gradient is (-n, n x s_A, n, s_B x n). Moving or turning
/// both bodies together changes no distance: rows that belong to that sum to zero.
struct [[nodiscard]] DistanceDerivatives {
  PoseGradient gradient = PoseGradient::Constant(std::numeric_limits<double>::quiet_NaN());  ///< d distance / dx
  /// Second derivatives of the distance at x = 0, symmetric.
  PoseHessian hessian = PoseHessian::Constant(std::numeric_limits<double>::quiet_NaN());
  PoseJacobian normal = PoseJacobian::Constant(std::numeric_limits<double>::quiet_NaN());   ///< d normal / dx
  PoseJacobian point_a = PoseJacobian::Constant(std::numeric_limits<double>::quiet_NaN());  ///< d point_a / dx
  PoseJacobian point_b = PoseJacobian::Constant(std::numeric_limits<double>::quiet_NaN());  ///< d point_b / dx
  /// Least eigenvalue (length) of W = T'(H_A + H_B)T + distance over the directions in which the normal is free to
  /// turn, H the Hessians of the support functions, T spanning the plane across n. Infinite where faces or edges fix
  /// the normal. Near zero the derivatives are large; at zero and below the optimum is not strict.
  double stiffness = std::numeric_limits<double>::quiet_NaN();
  DerivativeStatus status = DerivativeStatus::no_distance;

  bool twice() const { return status == DerivativeStatus::twice; }  ///< whether all derivatives exist
};

namespace kernel {

/// Shape at a pose with a ball swept over it. Refers to the shape, which must outlive it. Either `core` or `plane` or
/// the support functions say what the shape is.
struct ContactBody {
  Pose X_WS;               ///< pose of the shape in the world
  Eigen::Vector3d centre;  ///< point about which the body turns
  double skin = 0;         ///< radius of the ball, without that of the core
  double bounding_radius = 0;
  double curvature_radius = 0;       ///< lower bound of all radii of curvature, ball included
  std::optional<CoreView> core;      ///< a CoreShape
  const HalfSpace* plane = nullptr;  ///< a half-space
  const void* shape = nullptr;       ///< shape of another kind, argument of the two functions
  Support (*support)(const void*, const Eigen::Vector3d&) = nullptr;
  Eigen::Matrix3d (*hessian)(const void*, const Eigen::Vector3d&) = nullptr;
};

/// Returns the view of a shape at X_WS.
/// @{
template <SupportShape Shape>
ContactBody contact_body(const Shape& shape, const Pose& X_WS) {
  ContactBody body;
  body.X_WS = X_WS;
  body.centre = X_WS.position();
  body.bounding_radius = shape.bounding_radius();
  body.curvature_radius = min_curvature_radius_or_zero(shape);
  if constexpr (CoreShape<Shape>) {
    body.core = shape.core();
  } else {
    body.shape = &shape;
    body.support = [](const void* s, const Eigen::Vector3d& n) {
      return Support(static_cast<const Shape*>(s)->support(n));
    };
    body.hessian = [](const void* s, const Eigen::Vector3d& n) {
      return Eigen::Matrix3d(static_cast<const Shape*>(s)->support_hessian(n));
    };
  }
  return body;
}
inline ContactBody contact_body(const HalfSpace& shape, const Pose& X_WS) {
  ContactBody body;
  body.X_WS = X_WS;
  body.centre = X_WS.position();
  body.curvature_radius = std::numeric_limits<double>::infinity();
  body.plane = &shape;
  return body;
}
template <SupportShape Inner>
requires(!CoreShape<Inner>) ContactBody contact_body(const Rounded<Inner>& shape, const Pose& X_WS);
inline ContactBody contact_body(const AnyConvex& shape, const Pose& X_WS) {
  const AnyConvex::Part& part = shape.part();
  ContactBody body;
  body.X_WS = X_WS * part.X_BI;
  body.centre = X_WS.position();
  body.skin = part.skin;
  body.bounding_radius = part.shape->bounding_radius() + part.skin;
  body.curvature_radius = part.shape->min_curvature_radius() + part.skin;
  body.core = part.shape->core();
  body.shape = part.shape.get();
  body.support = [](const void* s, const Eigen::Vector3d& n) {
    return static_cast<const AnyConvex::Concept*>(s)->support(n);
  };
  body.hessian = [](const void* s, const Eigen::Vector3d& n) {
    return static_cast<const AnyConvex::Concept*>(s)->support_hessian(n);
  };
  return body;
}
template <SupportShape Inner>
ContactBody contact_body(const Placed<Inner>& shape, const Pose& X_WS) {
  ContactBody body = contact_body(shape.inner(), X_WS * shape.pose());
  body.centre = X_WS.position();
  return body;
}
template <SupportShape Inner>
requires(!CoreShape<Inner>) ContactBody contact_body(const Rounded<Inner>& shape, const Pose& X_WS) {
  ContactBody body = contact_body(shape.inner(), X_WS);
  body.skin += shape.radius();
  body.bounding_radius += shape.radius();
  body.curvature_radius += shape.radius();
  return body;
}
template <class... Shapes>
ContactBody contact_body(const std::variant<Shapes...>& shape, const Pose& X_WS) {
  return std::visit([&](const auto& s) { return contact_body(s, X_WS); }, shape);
}
/// @}

/// Two bodies whose distance has derivatives: any shapes, or a half-space and a shape.
template <class A, class B>
concept DifferentiablePair = (SupportShape<A> && SupportShape<B>) || (std::same_as<A, HalfSpace> && SupportShape<B>) ||
                             (SupportShape<A> && std::same_as<B, HalfSpace>) ||
                             (std::same_as<A, HalfSpace> && std::same_as<B, Shape>);

/// Trial of whether another normal is as good as that of an answer: B moved by `by`, against the normal.
struct RivalTrial {
  bool needed = false;
  double length = 0;
  Eigen::Vector3d by = Eigen::Vector3d::Zero();
  double rounding = 0;  ///< error of a distance by the rounding of positions
};

/// Returns the trial that an answer needs.
GEOM_EXPORT RivalTrial rival_trial(const ContactBody& a, const ContactBody& b, const DistanceResult& at);

/// Returns whether the distance after the trial is less by its length, as it is if no other normal is as good.
GEOM_EXPORT bool confirms(const RivalTrial& trial, const DistanceResult& at, const DistanceResult& moved);

/// Returns the derivatives at the optimum of an answer; `single`: whether that is known to be the only one.
GEOM_EXPORT DistanceDerivatives contact_derivatives(const ContactBody& a, const ContactBody& b,
                                                    const DistanceResult& at, bool single);

/// Implements distance_derivatives, for all that has a distance.
template <class A, class B>
DistanceDerivatives derivatives_at(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB,
                                   const DistanceResult& at) {
  const ContactBody in_a = contact_body(a, X_WA);
  const ContactBody in_b = contact_body(b, X_WB);
  const RivalTrial trial = rival_trial(in_a, in_b, at);
  bool single = true;
  if (trial.needed) {
    single = confirms(trial, at, distance(a, X_WA, b, moved(X_WB, trial.by)));
  }
  return contact_derivatives(in_a, in_b, at, single);
}

}  // namespace kernel

/// Returns the derivatives of a distance that `distance` has returned for this pair: `at`. Bodies may be any
/// SupportShape, geom::Shape, or one of them a HalfSpace.
///
/// The closest points of two bodies are those of features: a point, an edge, a face, a rim, a round side, or a smooth
/// surface. While the features stay the same, distance, normal and points are smooth functions of the poses, which
/// follow from one linear system: that of the last Newton step, with a row for each direction in which a point is free
/// to slide (docs/derivatives.md). The features are found from points and normal; both are then improved by Newton
/// steps, so that an `at` of lower accuracy does no harm.
///
/// Where they exist. Bodies apart, in general position: all, for every shape of libgeom. At a position within
/// kFeatureMargin of the size from a change of features, less is returned, as `status` says. Overlapping bodies: the
/// same, at the normal of `at`, where that optimum is strict. Deeper than the sum of both `min_curvature_radius`, other
/// normals may be as good: a second `distance` query, with B moved against the normal, then has to confirm the normal,
/// else `status` is `none`; it costs as much as the first one. It tells normals apart that differ by more than the
/// square root of 2 errors / length, the length of the move being 1e-6 of the size or 10^4 errors: 1e-4 radian where
/// errors are of rounding, 0.03 at most. A local penetration (infinite `error_bound`) has the
/// derivatives of that local depth and is not tested.
///
/// Accuracy where `twice`, for bodies of aspect ratios up to 4 and lengths of about their size: gradient 1e-9, Hessian
/// 1e-7 of its norm, asserted against differences by tests/unit/geom/derivatives; less where `stiffness` is
/// small. A user's SupportShape needs a `support_hessian` that is the derivative of its
/// support points; where that is not finite, only the gradient is returned. Nothing throws or allocates but functions
/// of a user's shape.
template <class ShapeA, class ShapeB>
requires kernel::DifferentiablePair<ShapeA, ShapeB> DistanceDerivatives
distance_derivatives(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const DistanceResult& at);

/// Overload that computes the distance first; `at`, if given, becomes its answer.
template <class ShapeA, class ShapeB>
requires kernel::DifferentiablePair<ShapeA, ShapeB> DistanceDerivatives
distance_derivatives(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                     const DistanceOptions& options = {}, DistanceResult* at = nullptr);

/// Overloads for shapes chosen at run time, compiled into the library.
/// @{
GEOM_EXPORT DistanceDerivatives distance_derivatives(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                                     const DistanceResult& at);
GEOM_EXPORT DistanceDerivatives distance_derivatives(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                                     const DistanceOptions& options = {}, DistanceResult* at = nullptr);
/// @}

/// Computes results[i] = distance_derivatives(a[i], X_WA[i], b[i], X_WB[i], at[i]), for answers of `distance_batch`.
/// Each of the four spans of bodies holds one element a pair, or a single one that serves all pairs. Returns the number
/// of pairs that have all derivatives. Throws std::invalid_argument, before anything is computed, if the size of one of
/// them is neither 1 nor results.size(), or that of `at` is not results.size(). Never allocates.
GEOM_EXPORT std::size_t distance_derivatives_batch(std::span<const Shape> a, std::span<const Pose> X_WA,
                                                   std::span<const Shape> b, std::span<const Pose> X_WB,
                                                   std::span<const DistanceResult> at,
                                                   std::span<DistanceDerivatives> results);

template <class ShapeA, class ShapeB>
requires kernel::DifferentiablePair<ShapeA, ShapeB> DistanceDerivatives
distance_derivatives(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const DistanceResult& at) {
  return kernel::derivatives_at(a, X_WA, b, X_WB, at);
}

template <class ShapeA, class ShapeB>
requires kernel::DifferentiablePair<ShapeA, ShapeB> DistanceDerivatives
distance_derivatives(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB,
                     const DistanceOptions& options, DistanceResult* at) {
  const DistanceResult found = distance(a, X_WA, b, X_WB, options);
  if (at != nullptr) *at = found;
  return distance_derivatives(a, X_WA, b, X_WB, found);
}

}  // namespace geom
