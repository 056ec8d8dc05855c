#pragma once

/// Distances of bodies that a ball is swept over: by those of the bodies inside; of a capsule and a smooth body, by
/// that of a ball on the capsule's axis.

#include <geom/capsule.h>
#include <geom/distance.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <utility>

namespace geom::kernel {

/// Returns the distance of two cores with their balls.
GEOM_EXPORT DistanceResult core_distance(const CoreView& a, const Pose& X_WA, const CoreView& b, const Pose& X_WB,
                                         const DistanceOptions& options);

/// Whether a type is geom::Rounded of some shape, which rounded.h says.
template <class T>
inline constexpr bool kIsRounded = false;

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
DistanceResult capsule_distance(const Capsule& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                const DistanceOptions& options) {
  constexpr int kMostPlaces = 40;
  const double l = a.half_length();
  const Ellipsoid ball(Eigen::Vector3d::Constant(a.radius()));
  const Eigen::Vector3d u = X_WA.rotation().col(2);
  const Eigen::Vector3d r_AB = X_WB.position() - X_WA.position();
  const double size = r_AB.norm() + a.bounding_radius() + b.bounding_radius();
  DistanceOptions local = options;
  local.penetration = Penetration::local;
  ClosestPlace place(l);
  double at = std::clamp(u.dot(r_AB), -l, l);
  DistanceResult best;
  int spent = 0;
  for (int k = 0; k < kMostPlaces; ++k) {
    DistanceResult r = distance(ball, Pose::translation(X_WA.position() + at * u), b, X_WB, local);
    spent += r.iterations;
    if (!(r.distance + a.radius() > 0) || !(r.error_bound <= kBoundGap * size)) return {};
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

}  // namespace geom::kernel
