#pragma once

/// Distances of bodies that a ball is swept over: by those of the bodies inside; of a capsule and a smooth body, by
/// that of a ball on the capsule's axis.

#include <geom/distance.h>
#include <geom/kernel/core.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <optional>
#include <utility>

namespace geom::kernel {

/// Returns the distance of two cores with their balls.
GEOM_EXPORT DistanceResult core_distance(const CoreView& a, const Pose& X_WA, const CoreView& b, const Pose& X_WB,
                                         const DistanceOptions& options);

/// Returns whether a point is in a core with its ball or on its surface: without a ball by the planes of the faces,
/// else to the rounding of its distance from the core.
GEOM_EXPORT bool core_contains(const CoreView& core, const Eigen::Vector3d& x);

/// Body that consists of one point.
struct Point {
  Support support(const Eigen::Vector3d& /*n*/) const { return {0, Eigen::Vector3d::Zero()}; }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& /*n*/) const { return Eigen::Matrix3d::Zero(); }
  double bounding_radius() const { return 0; }
  double inscribed_radius() const { return 0; }
  double min_curvature_radius() const { return 0; }
  CoreView core() const { return {}; }
};

/// Body that is a core with its ball, whatever the type of the shape that it is taken from: templates of two bodies are
/// instantiated once for all CoreShapes. Refers to the shape.
class CoreBody {
 public:
  template <CoreShape Shape>
  explicit CoreBody(const Shape& shape) : CoreBody(shape.core(), shape.inscribed_radius()) {}
  CoreBody(const CoreView& core, double inscribed_radius) : core_(core), inscribed_radius_(inscribed_radius) {}

  Support support(const Eigen::Vector3d& n) const { return swept_support(core_, n); }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const {
    const Eigen::Matrix3d of_ball = ball_hessian(core_.radius, n);
    return core_.kind == CoreKind::frustum ? Eigen::Matrix3d(of_ball + rim_hessian(core_, n)) : of_ball;
  }
  double bounding_radius() const { return core_.bounding_radius + core_.radius; }
  double inscribed_radius() const { return inscribed_radius_; }
  double min_curvature_radius() const { return core_.radius; }
  /// Returns the axis of revolution: z but for boxes and polyhedra.
  std::optional<int> symmetry_axis() const {
    const bool flat = core_.kind == CoreKind::box || core_.kind == CoreKind::hull;
    return flat ? std::nullopt : std::optional<int>(2);
  }
  CoreView core() const { return core_; }
  bool contains(const Eigen::Vector3d& x) const { return core_contains(core_, x); }
  /// Returns the core without its ball.
  CoreBody bare() const {
    CoreBody body = *this;
    body.core_.radius = 0;
    body.inscribed_radius_ -= core_.radius;
    return body;
  }

 private:
  CoreView core_;
  double inscribed_radius_;
};

/// Whether a type is geom::Rounded of some shape, which rounded.h says.
template <class T>
inline constexpr bool kIsRounded = false;

/// Whether a type is geom::Rounded of a shape that is no CoreShape.
template <class T>
inline constexpr bool kIsRoundedBody = kIsRounded<T> && !CoreShape<T>;

/// Whether a type is a CoreShape other than a point.
template <class T>
inline constexpr bool kHasBall = CoreShape<T> && !std::same_as<T, Point>;

/// Returns the answer for bodies that are larger by a ball of radius `skin_a` or `skin_b`.
inline DistanceResult with_skins(DistanceResult r, double skin_a, double skin_b) {
  if (r.status != DistanceStatus::separated && r.status != DistanceStatus::overlapping) return r;
  r.distance = (r.distance - skin_a) - skin_b;
  r.point_a += skin_a * r.normal;
  r.point_b = r.point_a + r.distance * r.normal;
  r.status = r.distance >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  return r;
}

/// Place of the ball on the axis, in [low, high], where the ball is closest to a convex body.
///
/// The distance is a convex function of the place with the derivative -n.u, u the axis: a root is enclosed and found by
/// the secant of both ends (the Illinois variant of regula falsi, which halves the value at an end that stays).
class ClosestPlace {
 public:
  explicit ClosestPlace(double half_length) : low_(-half_length), high_(half_length) {}

  /// Takes the slope at a place and returns the next one.
  double next(double at, double slope) {
    if (slope < 0) {
      low_ = at;
      slope_low_ = slope;
      if (last_ < 0 && slope_high_ > 0) slope_high_ *= 0.5;
      last_ = -1;
    } else {
      high_ = at;
      slope_high_ = slope;
      if (last_ > 0 && slope_low_ < 0) slope_low_ *= 0.5;
      last_ = 1;
    }
    // An end whose slope is not known yet is tried itself: the closest place may be there.
    if (slope_low_ == 0) return low_;
    if (slope_high_ == 0) return high_;
    const double share = slope_low_ / (slope_low_ - slope_high_);
    return low_ + share * (high_ - low_);
  }

 private:
  double low_, high_;
  double slope_low_ = 0, slope_high_ = 0;  // 0: not known yet
  int last_ = 0;
};

/// Returns the distance of a capsule and a body, or declines where the ball's places do not lead to it: bodies that
/// reach the axis, and normals that jump.
template <class Shape>
DistanceResult capsule_distance(double l, double radius, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                const DistanceOptions& options) {
  constexpr int kMostPlaces = 40;
  const Ellipsoid ball(Eigen::Vector3d::Constant(radius));
  const Eigen::Vector3d u = X_WA.rotation().col(2);
  const Eigen::Vector3d r_AB = X_WB.position() - X_WA.position();
  const double size = r_AB.norm() + (l + radius) + b.bounding_radius();
  DistanceOptions local = options;
  local.penetration = Penetration::local;
  ClosestPlace place(l);
  double at = std::clamp(u.dot(r_AB), -l, l);
  DistanceResult best;
  int spent = 0;
  for (int k = 0; k < kMostPlaces; ++k) {
    DistanceResult r = distance(ball, Pose::translation(X_WA.position() + at * u), b, X_WB, local);
    spent += r.iterations;
    if (!(r.distance + radius > 0) || !(r.error_bound <= kBoundGap * size)) return {};
    // The whole capsule is below the ball's tangent plane but for an end.
    const double slope = r.normal.dot(u);
    const double above = std::max(0.0, l * std::abs(slope) - at * slope);
    r.error_bound += above;
    if (!(best.error_bound <= r.error_bound)) {
      best = r;
      best.distance -= above;
      best.residual += above;
    }
    if (above <= 1e-16 * size) break;
    const double next = place.next(at, -slope);
    if (next == at) break;
    at = next;
    local.start = r.normal;
  }
  if (!(best.error_bound <= kBoundGap * size)) return {};
  best.point_b = best.point_a + best.distance * best.normal;
  best.status = best.distance >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  best.iterations = spent;
  return best;
}

/// Returns the same answer with the bodies exchanged.
inline DistanceResult exchanged(DistanceResult r) {
  std::swap(r.point_a, r.point_b);
  r.normal = -r.normal;
  return r;
}

/// Returns the distance of a core with its ball and a body that is none: a ball is an ellipsoid with three equal
/// semi-axes, a capsule has the closest ball on its axis, boxes and hulls the general method for the core alone.
template <class Shape>
DistanceResult core_to_body(const CoreBody& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                            const DistanceOptions& options) {
  const CoreView& core = a.core();
  const bool has_ball = core.radius >= kMinSemiAxis && core.radius <= kMaxSemiAxis;
  if (core.kind == CoreKind::point && has_ball) {
    return distance(Ellipsoid(Eigen::Vector3d::Constant(core.radius)), X_WA, b, X_WB, options);
  }
  if (core.kind == CoreKind::segment && has_ball) {
    const DistanceResult r = capsule_distance(core.half.z(), core.radius, X_WA, b, X_WB, options);
    return r.status != DistanceStatus::not_converged ? r : general_distance(a, X_WA, b, X_WB, options);
  }
  return with_skins(general_distance(a.bare(), X_WA, b, X_WB, options), core.radius, 0);
}

/// Returns core_to_body(), compiled into the library; of boxes and hulls that are apart, the distance of their closest
/// features.
/// @{
GEOM_EXPORT DistanceResult core_to_smooth(const CoreBody& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
                                          const DistanceOptions& options);
GEOM_EXPORT DistanceResult core_to_smooth(const CoreBody& a, const Pose& X_WA, const Superellipsoid& b,
                                          const Pose& X_WB, const DistanceOptions& options);
/// @}

/// Shape that core_to_smooth() takes.
template <class T>
concept SmoothShape = std::same_as<T, Ellipsoid> || std::same_as<T, Superellipsoid>;

}  // namespace geom::kernel
